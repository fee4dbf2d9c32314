-- The pages that explain the codes of findings, in a float.

local level = require('hyped.level')

local M = {}

--- The codes of the findings at the cursor, or else in its line.
local function codes_at_cursor()
  local row, column = unpack(vim.api.nvim_win_get_cursor(0))
  local here, line = {}, {}
  for _, found in ipairs(vim.diagnostic.get(0, { lnum = row - 1 })) do
    local code = tostring(found.code or '')
    if code:find('^[EW]%d+$') then
      local list = found.col <= column and column < found.end_col and here or line
      if not vim.tbl_contains(list, code) then
        list[#list + 1] = code
      end
    end
  end
  return #here > 0 and here or line
end

--- Shows the page of a code, or of the finding at the cursor.
---@param code string?
function M.show(code)
  local file = vim.api.nvim_buf_get_name(0)
  local function show(chosen)
    if not chosen then
      return
    end
    level.request(file, 'hypedc/explain', { code = chosen }, function(page)
      vim.lsp.util.open_floating_preview(vim.split(page.markdown, '\n'), 'markdown', { focus_id = 'hyped.explain', max_width = 100 })
    end)
  end
  local codes = code and { code } or codes_at_cursor()
  if #codes == 0 then
    vim.notify('hypedc: no finding is at the cursor')
  elseif #codes == 1 then
    show(codes[1])
  else
    vim.ui.select(codes, { prompt = 'Which finding?' }, show)
  end
end

return M
