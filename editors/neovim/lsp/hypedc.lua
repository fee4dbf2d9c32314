-- The configuration of the language server for `vim.lsp.enable('hypedc')`; `vim.lsp.config('hypedc', { … })` extends
-- it.
return {
  cmd = { vim.g.hypedc_path or 'hypedc', 'lsp' },
  filetypes = { 'hyped' },
  root_markers = { '.git' },
  init_options = { verdicts = require('hyped.verdicts').wanted() },
}
