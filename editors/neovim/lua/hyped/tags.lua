-- The colours of tags: each tag of a program has one of six, the same wherever it stands. A colour scheme may define
-- them itself, as `@lsp.typemod.label.tag1.hyped` to `…tag6.hyped`.

local M = {}

local COLORS = {
  dark = { '#e2a55e', '#f28ba8', '#8bd17c', '#b59df0', '#5ad1d8', '#d3c75a' },
  light = { '#9a5a00', '#b0305c', '#2e7d32', '#6a45c5', '#00707a', '#7a6a00' },
}

local function define()
  for number, color in ipairs(COLORS[vim.o.background]) do
    vim.api.nvim_set_hl(0, ('@lsp.typemod.label.tag%d.hyped'):format(number), { fg = color, default = true })
  end
end

function M.enable()
  define()
  vim.api.nvim_create_autocmd('ColorScheme', { callback = define })
end

return M
