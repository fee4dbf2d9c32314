-- Tests of programs: `:HypedTest` runs them in the language server, on the text of the buffer, and shows failures at their
-- lines as diagnostics.

local M = {}

local namespace = vim.api.nvim_create_namespace('hyped.tests')

--- The values of a part of a predicate: `hero.x > 3: 2 and 3`.
local function values(part)
  local held = part.held == true and 'holds' or 'does not hold'
  local sides = type(part.sides) == 'table' and (': %g and %g'):format(part.sides[1], part.sides[2]) or ''
  return ('`%s` %s%s'):format(part.text, held, sides)
end

--- A diagnostic at a place, whose lines and columns begin with 1 and count UTF-16 code units.
local function at(buffer, place, lines)
  local text = vim.api.nvim_buf_get_lines(buffer, place.line - 1, place.line, false)[1] or ''
  local column = vim.str_byteindex(text, 'utf-16', place.column - 1, false)
  return {
    lnum = place.line - 1,
    col = column,
    end_lnum = place.end_line - 1,
    end_col = place.end_line == place.line and vim.str_byteindex(text, 'utf-16', place.end_column - 1, false) or column,
    severity = vim.diagnostic.severity.ERROR,
    source = 'hypedc test',
    message = table.concat(lines, '\n'),
  }
end

--- The failures of a result as diagnostics of a buffer.
function M.failures(buffer, result)
  local found = {}
  local name = vim.fs.normalize(vim.api.nvim_buf_get_name(buffer))
  for _, test in ipairs(result.tests) do
    for _, problem in ipairs(test.problems) do
      found[#found + 1] = at(buffer, test.place, { ('test "%s": %s'):format(test.test, problem) })
    end
    for _, claim in ipairs(test.claims) do
      if not claim.passed and vim.fs.normalize(claim.place.path) == name then
        local lines = { ('test "%s": %s'):format(test.test, claim.answer) }
        vim.list_extend(lines, claim.reasons)
        vim.list_extend(lines, vim.tbl_map(values, claim.parts))
        found[#found + 1] = at(buffer, claim.place, lines)
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
