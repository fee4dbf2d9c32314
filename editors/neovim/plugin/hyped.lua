-- What Neovim (0.11 or later) does with .hyped; settings are in `lua/hyped/init.lua`.
if vim.g.loaded_hyped then
  return
end
vim.g.loaded_hyped = true

require('hyped').enable()
