" Settings for .hyped, consistent with `hypedc fmt`.

if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1

setlocal comments=:///,:// commentstring=//\ %s
setlocal formatoptions-=t formatoptions+=croql
setlocal expandtab shiftwidth=4 softtabstop=4 tabstop=4
setlocal iskeyword=@,48-57,_
setlocal suffixesadd=.hyped
setlocal include=^\\s*import\\s
setlocal define=^\\s*\\%(entity\\\|behavior\\\|world\\\|const\\\|param\\\|continuous\\\|discrete\\\|ref\\\|mode\\\|group\\)\\s
compiler hypedc

let b:undo_ftplugin = 'setlocal comments< commentstring< formatoptions< expandtab< shiftwidth< softtabstop< tabstop<'
      \ . ' iskeyword< suffixesadd< include< define< makeprg< errorformat< | unlet! b:current_compiler'
