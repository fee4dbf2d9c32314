-- Tests of programs: `:HypedTest` runs them in the language server, on the text of the buffer, and shows failures at their
-- lines as diagnostics.

local answers = require('hyped.answers')

local M = {}

local namespace = vim.api.nvim_create_namespace('hyped.tests')

--- A diagnostic at a place, whose lines and columns begin with 1 and count UTF-16 code units.
local function at(buffer, place, message)
  local text = vim.api.nvim_buf_get_lines(buffer, place.line - 1, place.line, false)[1] or ''
  local column = vim.str_byteindex(text, 'utf-16', place.column - 1, false)
  return {
    lnum = place.line - 1,
    col = column,
    end_lnum = place.end_line - 1,
    end_col = place.end_line == place.line and vim.str_byteindex(text, 'utf-16', place.end_column - 1, false) or column,
    severity = vim.diagnostic.severity.ERROR,
    source = 'hypedc test',
    message = message,
  }
end

--- The failures of a result as diagnostics of a buffer.
function M.failures(buffer, result)
  local found = {}
  local name = vim.fs.normalize(vim.api.nvim_buf_get_name(buffer))
  for _, test in ipairs(result.tests) do
    for _, failure in ipairs(answers.failures(test)) do
      if vim.fs.normalize(failure.place.path) == name then
        found[#found + 1] = at(buffer, failure.place, failure.message)
      end
    end
  end
  return found
end

--- Runs the tests of a buffer, or the one of a name; `done` is told what came of it.
---@param buffer integer
---@param name string?
---@param done fun(result: table)?
function M.run(buffer, name, done)
  local client = vim.lsp.get_clients({ bufnr = buffer, name = 'hypedc' })[1]
  if not client then
    vim.notify('The language server of hypedc does not run.', vim.log.levels.ERROR)
    return
  end
  local about = { uri = vim.uri_from_bufnr(buffer), tests = name and { name } or nil }
  local params = { command = 'hypedc.test', arguments = { about } }
  client:request('workspace/executeCommand', params, function(failure, result)
    if failure then
      vim.notify(failure.message, vim.log.levels.ERROR)
      return
    end
    if vim.api.nvim_buf_is_valid(buffer) then
      vim.diagnostic.set(namespace, buffer, M.failures(buffer, result))
    end
    local level = result.failed > 0 and vim.log.levels.WARN or vim.log.levels.INFO
    vim.notify(('%d passed, %d failed'):format(result.passed, result.failed), level)
    if done then
      done(result)
    end
  end, buffer)
end

--- The names of the tests of a buffer, for the completion of the command line.
function M.names(buffer)
  local names = {}
  for _, line in ipairs(vim.api.nvim_buf_get_lines(buffer, 0, -1, false)) do
    names[#names + 1] = line:match('^%s*test%s+"([^"]*)"')
  end
  return names
end

return M
