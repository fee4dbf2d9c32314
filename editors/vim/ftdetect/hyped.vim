" Files of the .hyped language.
autocmd BufNewFile,BufRead *.hyped setfiletype hyped
