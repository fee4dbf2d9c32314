-- Shared test code: `dofile('test/harness.lua')` in the plugin's folder installs the plugin as a user would, with
-- $HYPEDC as the hypedc executable.

local M = {}

local passed, failed = 0, 0

function M.test(name, body)
  local right, message = xpcall(body, debug.traceback)
  passed, failed = passed + (right and 1 or 0), failed + (right and 0 or 1)
  print(('%s: %s'):format(name, right and 'ok' or 'FAILED\n' .. message))
end

function M.same(found, expected, what)
  if not vim.deep_equal(found, expected) then
    error(('%s: found %s, not %s'):format(what or '', vim.inspect(found), vim.inspect(expected)), 2)
  end
end

function M.wait_for(what, condition)
  if not vim.wait(20000, condition, 20) then
    error('never: ' .. what, 2)
  end
end

-- Prints the number of passed tests, and exits with 1 if one failed.
function M.finish()
  print(('%d passed, %d failed'):format(passed, failed))
  os.exit(failed == 0 and 0 or 1)
end

vim.g.hypedc_path = assert(os.getenv('HYPEDC'), '$HYPEDC, the command hypedc, is not set')
vim.opt.runtimepath:prepend(vim.fn.getcwd())
vim.cmd('filetype plugin indent on')
vim.cmd('syntax on')
vim.cmd('runtime! plugin/hyped.lua')
vim.o.swapfile, vim.o.hidden = false, true

return M
