-- Tests of the Neovim plugin: `nvim --headless --clean -l test/run.lua` in its folder, with
--
--     $WORDS    the output of editors/test/words.mjs
--     $TIDY     a folder of programs formatted by `hypedc fmt`
--     $HYPEDC   the hypedc executable
--
-- The parser must have been built: `tree-sitter build` in ../tree-sitter-hyped.

local harness = dofile('test/harness.lua')
local test, same = harness.test, harness.same
local root = vim.fs.normalize('../..')

test('a file is taken for .hyped, with the settings of Vim', function()
  vim.cmd.edit(root .. '/examples/link.hyped')
  same(vim.bo.filetype, 'hyped')
  same(vim.bo.shiftwidth, 4)
  same(vim.bo.commentstring, '// %s')
  same(vim.bo.indentexpr, 'HypedIndent(v:lnum)')
  assert(vim.bo.makeprg:find('check --format short', 1, true), vim.bo.makeprg)
  same(vim.fn.exists(':HypedReach'), 2)
  same(vim.fn.exists(':HypedSim'), 2)
  same(vim.fn.exists(':HypedTest'), 2)
end)

test('the language server is known and enabled', function()
  local config = vim.lsp.config.hypedc
  same(config.cmd, { os.getenv('HYPEDC'), 'lsp' })
  same(config.filetypes, { 'hyped' })
  assert(vim.lsp._enabled_configs.hypedc or (vim.lsp.is_enabled and vim.lsp.is_enabled('hypedc')), 'it is not enabled')
end)

test('tree-sitter colours the text', function()
  vim.cmd.edit(root .. '/examples/link.hyped')
  local highlighter = vim.treesitter.highlighter.active[vim.api.nvim_get_current_buf()]
  assert(highlighter, 'no colours by tree-sitter')
  same(vim.treesitter.get_parser():lang(), 'hyped')
  for _, kind in ipairs({ 'highlights', 'folds', 'indents', 'injections', 'locals' }) do
    assert(vim.treesitter.query.get('hyped', kind), 'no query ' .. kind)
  end
end)

test('words are words and names are names', function()
  local wrong, count, path = {}, 0, nil
  for row in io.lines(os.getenv('WORDS')) do
    local file, line, start, _, kind, text = unpack(vim.split(row, '\t'))
    if file:find('/editors/') or file:find('/examples/') then
      if file ~= path then
        path = file
        vim.cmd.edit(path)
        vim.treesitter.get_parser():parse(true)
      end
      local word, captures = false, {}
      for _, capture in ipairs(vim.treesitter.get_captures_at_pos(0, line - 1, start - 1)) do
        captures[#captures + 1] = capture.capture
        -- The last capture determines the highlight.
        word = capture.capture:find('^keyword') or capture.capture == 'boolean' or capture.capture == 'variable.builtin'
          or capture.capture == 'constant.builtin'
      end
      count = count + 1
      if (word and 'word' or 'name') ~= kind then
        wrong[#wrong + 1] = ('%s:%s:%s: %s %s is %s'):format(file, line, start, kind, text, table.concat(captures, ' '))
      end
    end
  end
  assert(count > 3000, 'there is too little to compare')
  same(wrong, {})
end)

test('blocks and maps fold', function()
  vim.cmd.edit(root .. '/examples/link.hyped')
  vim.wo.foldmethod, vim.wo.foldexpr = 'expr', 'v:lua.vim.treesitter.foldexpr()'
  vim.cmd('normal! zx')
  vim.wait(1000, function() return vim.fn.foldlevel(6) > 0 end)
  local function level(pattern)
    return vim.fn.foldlevel(vim.fn.search(pattern, 'cwn'))
  end
  same({ level('^entity Link'), level('mode walk'), level('#######\\.\\.') }, { 1, 3, 3 })
end)

test('lines are indented as hypedc fmt does', function()
  local files = vim.fn.glob(os.getenv('TIDY') .. '/examples_*.hyped', false, true)
  assert(#files > 10, 'there is too little to indent')
  for _, file in ipairs(files) do
    vim.cmd.edit(file)
    local wanted = vim.api.nvim_buf_get_lines(0, 0, -1, true)
    vim.cmd([[silent %s/^\s\+//e]])
    vim.cmd('silent normal! gg=G')
    same(vim.api.nvim_buf_get_lines(0, 0, -1, true), wanted, file)
    vim.cmd('edit!')
  end
end)

test('code lenses run hypedc', function()
  local seen = {}
  local jobstart = vim.fn.jobstart
  vim.fn.jobstart = function(command, options)
    seen[#seen + 1] = vim.list_extend({ options.cwd }, command)
  end
  local uri = vim.uri_from_fname('/tmp/a b/c.hyped')
  local search, asked = require('hyped.search'), {}
  local reach = search.reach
  search.reach = function(file, about) asked[#asked + 1] = { file, about } end
  vim.lsp.commands['hypedc.reach']({ arguments = { uri, 'W', 'g' } }, {})
  vim.lsp.commands['hypedc.reach']({ arguments = { uri, 'W', 'n', vim.NIL, 'never' } }, {})
  vim.ui.input = function(_, answer)
    answer('jump*3')
  end
  vim.lsp.commands['hypedc.sim']({ arguments = { uri, 'W' } }, {})
  vim.lsp.commands['hypedc.play']({ arguments = { uri, 'W', 'g', { map = '/tmp/l.txt' }, 'right*9' } }, {})
  vim.fn.jobstart, search.reach = jobstart, reach
  local command = os.getenv('HYPEDC')
  same(seen, {
    { '/tmp/a b', command, 'sim', 'c.hyped', '--inputs', 'jump*3', '--world', 'W' },
    { '/tmp/a b', command, 'sim', 'c.hyped', '--inputs', 'right*9', '--world', 'W', '--map', '/tmp/l.txt' },
  })
  same(asked, {
    { '/tmp/a b/c.hyped', { world = 'W', goals = { 'g' } } },
    { '/tmp/a b/c.hyped', { world = 'W', nevers = { 'n' } } },
  })
end)

harness.finish()
