-- The language server, as `vim.lsp.enable('hypedc')` starts it. `vim.lsp.config('hypedc', { … })` changes it.
return {
  cmd = { vim.g.hypedc_path or 'hypedc', 'lsp' },
  filetypes = { 'hyped' },
  root_markers = { '.git' },
}
