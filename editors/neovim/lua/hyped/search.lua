-- Searches by the language server: on the texts of the buffers, not on the files. Their answers in a window of text.

local answers = require('hyped.answers')
local level = require('hyped.level')

local M = {}

--- Shows lines in a window at the bottom; the window is used again.
local function show(title, lines)
  local name = 'hyped://' .. title
  local buffer = vim.fn.bufnr(name)
  if buffer == -1 then
    buffer = vim.api.nvim_create_buf(false, true)
    vim.api.nvim_buf_set_name(buffer, name)
  end
  vim.bo[buffer].buftype, vim.bo[buffer].bufhidden = 'nofile', 'hide'
  vim.api.nvim_buf_set_lines(buffer, 0, -1, false, lines)
  if vim.fn.bufwinid(buffer) == -1 then
    vim.cmd('botright 12new')
    vim.api.nvim_win_set_buf(0, buffer)
    vim.cmd.wincmd('p')
  end
  return buffer
end

--- Asks a command of the server about the buffers, and shows its answers.
---@param file string
---@param about table the arguments: `world`, `goals`, `nevers`, `level`
function M.reach(file, about)
  local client = level.client(file)
  if not client then
    vim.notify('hypedc: the language server does not run', vim.log.levels.ERROR)
    return
  end
  local arguments = vim.tbl_extend('error', { uri = vim.uri_from_fname(file) }, about)
  local parameters = { command = 'hypedc.reach', arguments = { arguments } }
  client:request('workspace/executeCommand', parameters, function(failure, found)
    if failure then
      vim.notify('hypedc: ' .. failure.message, vim.log.levels.ERROR)
      return
    end
    local lines = { ('%s, world %s'):format(vim.fs.basename(file), found.world) }
    for _, answer in ipairs(found.goals) do
      vim.list_extend(lines, answers.lines_of(answer))
    end
    show('reach ' .. vim.fs.basename(file), lines)
  end)
end

return M
