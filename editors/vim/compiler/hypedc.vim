" `:make` checks the file; findings go into the quickfix list, with the number of their code in `nr`.

if exists('current_compiler')
  finish
endif
let current_compiler = 'hypedc'

let s:cpo = &cpo
set cpo&vim

" g:hypedc_path is the hypedc executable: a command on the PATH, or a path.
execute 'CompilerSet makeprg=' . escape(get(g:, 'hypedc_path', 'hypedc'), ' \|"') . '\ check\ --format\ short\ %:S'
CompilerSet errorformat=%f:%l:%c:\ %trror[E%n]:\ %m,%f:%l:%c:\ %tarning[W%n]:\ %m,%trror[E%n]:\ %m,%tarning[W%n]:\ %m

let &cpo = s:cpo
unlet s:cpo
