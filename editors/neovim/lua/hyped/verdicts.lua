-- Live verdicts at the end of the lines of goals and `never`s. `vim.g.hypedc_verdicts = false` turns them off.

local M = {}

local namespace = vim.api.nvim_create_namespace('hyped.verdicts')

local function highlight(verdict)
  if not verdict.isCurrent then
    return 'HypedVerdictOld'
  end
  return verdict.isGood == true and 'HypedVerdictGood' or verdict.isGood == false and 'HypedVerdictBad' or 'HypedVerdictOpen'
end

--- Whether verdicts are wanted: the option of `initialize`.
function M.wanted()
  return vim.g.hypedc_verdicts ~= false
end

--- Shows the verdicts on a document, as the server tells them.
function M.show(_, told)
  local buffer = vim.uri_to_bufnr(told.uri)
  if not vim.api.nvim_buf_is_loaded(buffer) then
    return
  end
  -- The marks of an outdated verdict stay where they are: its ranges are those of the older text.
  local known = {}
  for _, mark in ipairs(vim.api.nvim_buf_get_extmarks(buffer, namespace, 0, -1, {})) do
    known[mark[1]] = mark[2]
  end
  local kept = {}
  for _, verdict in ipairs(told.verdicts) do
    local key = table.concat({ verdict.world, verdict.kind, verdict.name }, '\n')
    local ids = vim.b[buffer].hyped_verdict_ids or {}
    local line = verdict.isCurrent and verdict.range ~= vim.NIL and verdict.range.start.line or known[ids[key]]
    if line and line < vim.api.nvim_buf_line_count(buffer) then
      ids[key] = vim.api.nvim_buf_set_extmark(buffer, namespace, line, 0, {
        id = ids[key],
        virt_text = { { ' ' .. verdict.title, highlight(verdict) } },
        hl_mode = 'combine',
      })
      kept[ids[key]] = true
      vim.b[buffer].hyped_verdict_ids = ids
    end
  end
  for id in pairs(known) do
    if not kept[id] then
      vim.api.nvim_buf_del_extmark(buffer, namespace, id)
    end
  end
end

--- What is shown in a buffer: the texts by line, from 0.
function M.shown(buffer)
  local found = {}
  for _, mark in ipairs(vim.api.nvim_buf_get_extmarks(buffer, namespace, 0, -1, { details = true })) do
    found[mark[2]] = vim.trim(mark[4].virt_text[1][1])
  end
  return found
end

function M.enable()
  for name, link in pairs({ Good = 'DiagnosticOk', Bad = 'DiagnosticError', Open = 'DiagnosticHint', Old = 'Comment' }) do
    vim.api.nvim_set_hl(0, 'HypedVerdict' .. name, { link = link, default = true })
  end
  vim.lsp.handlers['hypedc/verdicts'] = M.show
end

return M
