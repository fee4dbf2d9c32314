-- Tests of Neovim with `hypedc lsp`: findings, definitions, rename, formatting, repairs, in copies of the programs
-- ../test/mistakes and ../test/repairs. `nvim --headless --clean -l test/server.lua` in the plugin's folder, with $HYPEDC, the hypedc
-- executable.

local harness = dofile('test/harness.lua')
local test, same, wait_for = harness.test, harness.same, harness.wait_for

local folder = vim.fn.tempname()
vim.fn.mkdir(folder .. '/.git', 'p')
local programs = vim.fn.fnamemodify('../test', ':p')
local function copy(name)
  vim.fn.writefile(vim.fn.readfile(programs .. name, 'b'), folder .. '/' .. vim.fs.basename(name), 'b')
end
copy('mistakes/game.hyped')
copy('mistakes/slime.hyped')
-- To be imported; the server knows what is there as it starts.
copy('repairs/gem.hyped')
vim.cmd.cd(folder)
-- What the server remembers stays here.
vim.env.XDG_CACHE_HOME = folder .. '/cache'

vim.cmd.edit('slime.hyped')
local slime = vim.api.nvim_get_current_buf()
vim.cmd.edit('game.hyped')
local game = vim.api.nvim_get_current_buf()

-- The findings of `hypedc check` in the files on the disk.
local function checked()
  local out = vim.system({ os.getenv('HYPEDC'), 'check', '--format', 'short', 'game.hyped' }, { text = true }):wait().stdout
  local found = vim.split(vim.trim(out), '\n', { trimempty = true })
  table.sort(found)
  return found
end

-- The diagnostics that Neovim shows, in the same format: the first line of each.
local function shown()
  local found = {}
  for _, d in ipairs(vim.diagnostic.get()) do
    local name = vim.fs.basename(vim.api.nvim_buf_get_name(d.bufnr))
    local line = vim.api.nvim_buf_get_lines(d.bufnr, d.lnum, d.lnum + 1, true)[1]
    local column = vim.str_utfindex(line, 'utf-32', d.col) + 1
    local severity = d.severity == vim.diagnostic.severity.ERROR and 'error' or 'warning'
    found[#found + 1] = ('%s:%d:%d: %s[%s]: %s'):format(name, d.lnum + 1, column, severity, d.code, vim.split(d.message, '\n')[1])
  end
  table.sort(found)
  return found
end

-- Waits until Neovim shows the `count` findings of `hypedc check`.
local function agree(count)
  local told = checked()
  same(#told, count, table.concat(told, '\n'))
  vim.wait(20000, function() return vim.deep_equal(shown(), told) end, 20)
  same(shown(), told)
end

local function line(buffer, number)
  return vim.api.nvim_buf_get_lines(buffer, number - 1, number, true)[1]
end

test('the server starts, and finds what hypedc check finds', function()
  wait_for('a server', function() return #vim.lsp.get_clients({ bufnr = game, name = 'hypedc' }) == 1 end)
  agree(3)
end)

test('the finding at the cursor is explained', function()
  vim.cmd.buffer(game)
  local found = vim.diagnostic.get(game, { severity = vim.diagnostic.severity.ERROR })[1]
  vim.api.nvim_win_set_cursor(0, { found.lnum + 1, found.col })
  vim.cmd('HypedExplain')
  wait_for('the page', function()
    return vim.iter(vim.api.nvim_list_wins()):any(function(window)
      local lines = vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false)
      return vim.api.nvim_win_get_config(window).relative ~= '' and table.concat(lines, '\n'):find(found.code, 1, true) ~= nil
    end)
  end)
  vim.cmd('fclose!')
end)

test('findings go as soon as what was wrong is right, and others come', function()
  vim.cmd.buffer(slime)
  vim.cmd('silent %s/sise/size/')
  vim.cmd.buffer(game)
  vim.cmd('silent %s/Slim at/Slime at/ | %s/false/32/')
  vim.cmd('silent wall')
  agree(1)
end)

test('one goes to where an entity is defined, in another file', function()
  vim.api.nvim_win_set_cursor(0, { 8, 22 })
  vim.lsp.buf.definition()
  wait_for('the other file', function() return vim.api.nvim_get_current_buf() == slime end)
  same(vim.api.nvim_win_get_cursor(0), { 2, 7 })
  vim.cmd.buffer(game)
end)

test('an entity is renamed in both files', function()
  vim.api.nvim_win_set_cursor(0, { 8, 22 })
  vim.lsp.buf.rename('Ooze')
  wait_for('the new name', function() return line(game, 8):find('Ooze', 1, true) ~= nil end)
  same(line(game, 9), '        place second: Ooze at (32, 0) { speed = 40 }')
  same(line(slime, 2), 'entity Ooze {')
end)

test('the document gets its layout', function()
  vim.lsp.buf.format({ timeout_ms = 20000 })
  same(line(game, 12), '    goal over: first.x > 100')
  vim.cmd('silent wall')
  agree(1)
end)

test('what the cursor is on is told', function()
  local parameters = { textDocument = { uri = vim.uri_from_bufnr(game) }, position = { line = 7, character = 22 } }
  local answers = vim.lsp.buf_request_sync(game, 'textDocument/hover', parameters, 20000)
  assert(vim.inspect(answers):find('Creeps along', 1, true), vim.inspect(answers))
end)

test('tests run on the text of the buffer, and failures are shown at their lines', function()
  vim.cmd.buffer(game)
  local last = vim.api.nvim_buf_line_count(game)
  vim.api.nvim_buf_set_lines(game, last - 1, last - 1, true, {
    '    test "far" {',
    '        inputs "-*10"',
    '        expect first.x > 1000 at end',
    '    }',
  })
  local result
  require('hyped.tests').run(game, nil, function(told) result = told end)
  wait_for('the result', function() return result ~= nil end)
  same({ result.passed, result.failed }, { 0, 1 })
  local found = vim.tbl_filter(function(d) return d.source == 'hypedc test' end, vim.diagnostic.get(game))
  same(#found, 1)
  same({ found[1].lnum, found[1].col }, { last + 1, 8 })
  assert(found[1].message:find('and 1000', 1, true), found[1].message)
  same(require('hyped.tests').names(game), { 'far' })
  vim.cmd('silent undo')
end)

-- A world with a map, a goal, and a hero who walks.
local walk = {
  'entity Hero {',
  '    button right',
  '    collider body: rect(0, 0, 8, 8)',
  '    mode still {',
  "        x' = 0",
  '        when held(right) -> going',
  '    }',
  '    mode going {',
  "        x' = 60",
  '        when not held(right) -> still',
  '    }',
  '}',
  'world W {',
  '    step 1/60',
  '    collide body with wall: block',
  '    tiles land 16 x 16 {',
  "        '.': empty",
  "        '#': wall",
  '    }',
  '    space main {',
  '        map land "',
  '            ........',
  '            ########',
  '        "',
  '        place hero: Hero at (0, 16)',
  '    }',
  '    player 1: hero',
  '    goal over: hero.x > 40',
  '}',
}

local verdicts = require('hyped.verdicts')

test('a verdict stands at the goal, and an edit turns it', function()
  vim.fn.writefile(walk, folder .. '/walk.hyped')
  vim.cmd.edit('walk.hyped')
  local buffer = vim.api.nvim_get_current_buf()
  local function verdict()
    return verdicts.shown(buffer)[27]
  end
  wait_for('a verdict', function() return (verdict() or ''):find('^✓ ') end)
  vim.cmd('silent %s/= 60/= 0')
  wait_for('another verdict', function() return (verdict() or ''):find('^✗ proven') end)
  wait_for('a finding', function()
    return vim.iter(vim.diagnostic.get(buffer)):any(function(d) return d.code == 'broken-goal' end)
  end)
  vim.cmd('silent undo')
  wait_for('the verdict from before', function() return (verdict() or ''):find('^✓ ') end)
end)

test('the buffer is asked, not the file', function()
  vim.cmd('silent %s/> 40/> 44')
  vim.cmd('HypedReach over')
  local function answer()
    local buffer = vim.fn.bufnr('hyped://reach walk.hyped')
    return buffer ~= -1 and table.concat(vim.api.nvim_buf_get_lines(buffer, 0, -1, false), '\n') or ''
  end
  wait_for('an answer', function() return answer():find('goal over: reached', 1, true) end)
  vim.cmd('silent %s/> 44/< -9')
  vim.cmd('HypedReach over')
  wait_for('another answer', function() return answer():find('goal over: proven-unreachable', 1, true) end)
  vim.cmd('silent undo')
end)

test('the map is painted, and a tile tells how one gets there', function()
  local paint = require('hyped.paint')
  vim.cmd('HypedPaint')
  local namespace = vim.api.nvim_get_namespaces()['hyped.paint']
  local function groups()
    local found = {}
    for _, mark in ipairs(vim.api.nvim_buf_get_extmarks(0, namespace, { 21, 0 }, { 21, -1 }, { details = true })) do
      found[#found + 1] = mark[4].hl_group
    end
    return found
  end
  wait_for('paint', function() return #groups() == 8 end)
  same(groups()[1], 'HypedPaintWay')
  vim.api.nvim_win_set_cursor(0, { 22, 13 })
  local of, index, column, row = paint.tile_under_cursor()
  same({ index, column, row }, { 2, 1, 0 })
  assert(paint.tell(of, index, column, row)[2]:find('^first reached at step'), vim.inspect(paint.tell(of, index, column, row)))
  vim.cmd('HypedTile')
  wait_for('the way', function()
    return vim.iter(vim.api.nvim_list_wins()):any(function(window)
      local lines = vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false)
      return vim.iter(lines):any(function(line) return line:find('right*', 1, true) ~= nil end) and #lines < 9
    end)
  end)
  vim.cmd('silent %s/> 44/> 45')
  wait_for('no paint', function() return #groups() == 0 end)
end)

test('code actions mend what is found', function()
  copy('repairs/ball.hyped')
  vim.cmd.edit('ball.hyped')
  local buffer = vim.api.nvim_get_current_buf()
  local function text()
    return table.concat(vim.api.nvim_buf_get_lines(buffer, 0, -1, false), '\n')
  end
  -- Where the cursor is put, the action that is chosen, and what the text has, or has no more, then.
  for _, step in ipairs({
    { 'sliding', 'declare `mode sliding`', makes = 'mode sliding {' },
    { 'lives: int \\zs=', 'write `int 0..9`', makes = 'int 0..9 = 3' },
    { 'Gem', 'import `gem.hyped`', makes = 'import "gem.hyped"' },
    { 'weight', 'remove the parameter', removes = 'param weight' },
    { '120', 'extract a parameter', removes = 'x < 120' },
  }) do
    local at, title = step[1], step[2]
    local function is_done()
      return step.makes and text():find(step.makes, 1, true) ~= nil or step.removes and not text():find(step.removes, 1, true)
    end
    vim.fn.cursor(1, 1)
    assert(vim.fn.search(at, 'cW') > 0, at)
    -- Findings of the text of before have no fixes: it is asked for until it is there.
    wait_for(title, function()
      vim.lsp.buf.code_action({
        apply = true,
        filter = function(action) return action.title:find(title, 1, true) ~= nil end,
      })
      return vim.wait(500, is_done, 20)
    end)
  end
  wait_for('no error', function() return #vim.diagnostic.get(buffer, { severity = vim.diagnostic.severity.ERROR }) == 0 end)
end)

test('a tag has one colour wherever it stands, and another tag another one', function()
  vim.cmd.edit('walk.hyped')
  local buffer = vim.api.nvim_get_current_buf()
  local function groups(tag)
    local found = {}
    for number, text in ipairs(vim.api.nvim_buf_get_lines(buffer, 0, -1, false)) do
      local at = text:find('%f[%w]' .. tag .. '%f[%W]')
      for _, token in ipairs(at and vim.lsp.semantic_tokens.get_at_pos(buffer, number - 1, at - 1) or {}) do
        for modifier in pairs(token.type == 'label' and token.modifiers or {}) do
          if modifier:find('^tag%d$') then
            found[#found + 1] = ('@lsp.typemod.label.%s.hyped'):format(modifier)
          end
        end
      end
    end
    return found
  end
  wait_for('tokens', function() return #groups('wall') >= 2 and #groups('body') >= 2 end)
  local wall, body = groups('wall'), groups('body')
  for _, all in ipairs({ wall, body }) do
    for _, other in ipairs(all) do
      same(other, all[1])
    end
  end
  local colors = vim.iter({ wall[1], body[1] }):map(function(name) return vim.api.nvim_get_hl(0, { name = name }).fg end):totable()
  assert(colors[1] and colors[2] and colors[1] ~= colors[2], vim.inspect(colors))
end)

for _, client in ipairs(vim.lsp.get_clients()) do
  client:stop()
end
wait_for('the end of the server', function() return #vim.lsp.get_clients() == 0 end)
harness.finish()
