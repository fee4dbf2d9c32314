-- Support for .hyped in Neovim 0.11 or later; `lua/hyped/init.lua` lists the settings.
if vim.g.loaded_hyped then
  return
end
vim.g.loaded_hyped = true

require('hyped').enable()
