-- Neovim and `hypedc lsp`: findings, definitions, renaming, layout, in a project of two files.
-- `nvim --headless --clean -l test/server.lua` in the plugin's folder, with $HYPEDC, the command hypedc.

local passed, failed = 0, 0

local function test(name, body)
  local right, message = xpcall(body, debug.traceback)
  passed, failed = passed + (right and 1 or 0), failed + (right and 0 or 1)
  print(('%s: %s'):format(name, right and 'ok' or 'FAILED\n' .. message))
end

local function same(found, expected, what)
  if not vim.deep_equal(found, expected) then
    error(('%s: found %s, not %s'):format(what or '', vim.inspect(found), vim.inspect(expected)), 2)
  end
end

local function wait_for(what, condition)
  if not vim.wait(20000, condition, 20) then
    error('never: ' .. what, 2)
  end
end

vim.g.hypedc_path = os.getenv('HYPEDC')
vim.opt.runtimepath:prepend(vim.fn.getcwd())
vim.cmd('filetype plugin indent on')
vim.cmd('runtime! plugin/hyped.lua')
vim.o.swapfile, vim.o.hidden = false, true

local folder = vim.fn.tempname()
vim.fn.mkdir(folder .. '/.git', 'p')
local function write(name, text)
  vim.fn.writefile(vim.split(text, '\n'), folder .. '/' .. name)
end
write('slime.hyped', [[
/// Creeps along.
entity Slime {
    param speed = 20

    collider enemy: rect(0, 0, 16, 16)

    x' = speed
}]])
write('game.hyped', [[
import "slime.hyped"

world Cave {
    step 1/60

    space main {
        place first: Slime at (0, 0)
        place second: Slim at (32, 0) { speed = 40 }
    }

      goal over: first.x > 100
}]])

vim.cmd.edit(folder .. '/game.hyped')
local buffer = vim.api.nvim_get_current_buf()

local function messages()
  return vim.tbl_map(function(d) return d.message end, vim.diagnostic.get(buffer, { severity = vim.diagnostic.severity.ERROR }))
end

local function line(number)
  return vim.api.nvim_buf_get_lines(buffer, number - 1, number, true)[1]
end

test('the server starts, and its findings are there', function()
  wait_for('a server', function() return #vim.lsp.get_clients({ bufnr = buffer, name = 'hypedc' }) == 1 end)
  wait_for('a finding', function() return #messages() == 1 end)
  local found = vim.diagnostic.get(buffer, { severity = vim.diagnostic.severity.ERROR })[1]
  same({ found.lnum, found.col, found.code }, { 7, 22, 'E0201' })
  assert(found.message:find('Slim', 1, true), found.message)
end)

test('findings go as soon as what was wrong is right', function()
  vim.api.nvim_buf_set_lines(buffer, 7, 8, true, { (line(8):gsub('Slim at', 'Slime at')) })
  wait_for('no finding', function() return #messages() == 0 end)
end)

test('one goes to where an entity is defined, in another file', function()
  vim.api.nvim_win_set_cursor(0, { 7, 22 })
  vim.lsp.buf.definition()
  wait_for('the other file', function() return vim.api.nvim_buf_get_name(0):match('slime%.hyped$') end)
  same(vim.api.nvim_win_get_cursor(0), { 2, 7 })
  vim.cmd.buffer(buffer)
end)

test('an entity is renamed in both files', function()
  vim.api.nvim_win_set_cursor(0, { 7, 22 })
  vim.lsp.buf.rename('Ooze')
  wait_for('the new name', function() return line(7):find('Ooze', 1, true) ~= nil end)
  same(line(8), '        place second: Ooze at (32, 0) { speed = 40 }')
  local other = vim.fn.bufnr(folder .. '/slime.hyped')
  same(vim.api.nvim_buf_get_lines(other, 1, 2, true), { 'entity Ooze {' })
  wait_for('no finding', function() return #messages() == 0 end)
end)

test('the document gets its layout', function()
  vim.lsp.buf.format({ timeout_ms = 20000 })
  same(line(11), '    goal over: first.x > 100')
end)

test('what the cursor is on is told', function()
  local parameters = { textDocument = { uri = vim.uri_from_bufnr(buffer) }, position = { line = 6, character = 22 } }
  -- As soon as the text in its new layout was read.
  wait_for('what is documented', function()
    local answers = vim.lsp.buf_request_sync(buffer, 'textDocument/hover', parameters, 20000)
    return vim.inspect(answers):find('Creeps along', 1, true) ~= nil
  end)
end)

for _, client in ipairs(vim.lsp.get_clients()) do
  client:stop()
end
vim.wait(5000, function() return #vim.lsp.get_clients() == 0 end, 20)
print(('%d passed, %d failed'):format(passed, failed))
vim.cmd(failed == 0 and 'qall!' or 'cquit')
