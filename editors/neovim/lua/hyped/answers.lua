-- Answers of the server in words: of searches, and the failures of tests.

local M = {}

local function given(value)
  return value ~= nil and value ~= vim.NIL and value or nil
end

--- The lines that tell an answer of a search.
function M.lines_of(answer)
  local lines = { ('%s %s: %s'):format(answer.kind, answer.goal, answer.verdict) }
  local function add(label, text)
    lines[#lines + 1] = ('  %-8s%s'):format(label, text)
  end
  if given(answer.steps) then
    add('path', ('%d steps, %.2f s'):format(answer.steps, answer.seconds_of_play))
    add('inputs', answer.inputs)
  end
  for _, reason in ipairs(given(answer.reasons) or {}) do
    add('because', reason)
  end
  local near = given(answer.why_not) and given(answer.why_not.nearest)
  for _, part in ipairs(near and near.parts or {}) do
    if not part.holds then
      add('nearest', ('`%s` %s'):format(part.text, part.words))
    end
  end
  add('search', ('%d nodes'):format(answer.nodes))
  return lines
end

--- The values of a part of a predicate: `hero.x > 3: 2 and 3`.
local function values(part)
  local held = part.held == true and 'holds' or 'does not hold'
  local sides = type(part.sides) == 'table' and (': %g and %g'):format(part.sides[1], part.sides[2]) or ''
  return ('`%s` %s%s'):format(part.text, held, sides)
end

--- Why a test failed: each with its place, and the line of that from 0.
---@return { message: string, line: integer, place: table }[]
function M.failures(test)
  local found = {}
  local function add(place, lines)
    found[#found + 1] = { message = table.concat(lines, '\n'), line = place.line - 1, place = place }
  end
  for _, problem in ipairs(test.problems) do
    add(test.place, { ('test "%s": %s'):format(test.test, problem) })
  end
  for _, claim in ipairs(test.claims) do
    if not claim.passed then
      local lines = { ('test "%s": %s'):format(test.test, claim.answer) }
      vim.list_extend(lines, claim.reasons)
      vim.list_extend(lines, vim.tbl_map(values, claim.parts))
      add(claim.place, lines)
    end
  end
  return found
end

return M
