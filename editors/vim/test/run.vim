" Tests of the Vim files, run by `vim -Nu NONE -es -S test/run.vim` in the folder of the plugin, with
"
"     $WORDS    the output of editors/test/words.mjs
"     $TIDY     a folder of programs formatted by `hypedc fmt`
"     $HYPEDC   the hypedc executable
"
" Prints the failures, and exits with 1 if there are any.

set nocompatible hidden nomore noswapfile shellpipe=>%s\ 2>&1
let &runtimepath = getcwd() . ',' . $VIMRUNTIME
filetype plugin indent on
syntax on

let s:wrong = []
let s:WORD = '^hyped\%(OperatorWord\|Boolean\|Constant\|Variable\|Conditional\|Statement\|Follow\|Import\|Structure\|SpaceWord'
      \ . '\|Member\|Modifier\|Declaration\|DomainWord\|Envelope\|DriverWord\|Directions\|Fixed\|Ramp\|Rate\|Sustained\|Level'
      \ . '\|Item\|Times\|With\|ResponseWord\|Place\|MapWord\|TileWord\|TestWord\|Claim\|Moment\)$'

function s:Group(line, byte) abort
  return synIDattr(synID(a:line, a:byte, 1), 'name')
endfunction

" Keywords and names are those of the tree-sitter grammar.
function s:Words() abort
  let path = ''
  let rows = readfile($WORDS)
  if len(rows) < 10000
    call add(s:wrong, 'there is too little to compare')
  endif
  for row in rows
    let [file, line, start, _, kind, text] = split(row, "\t")
    if file !=# path
      let path = file
      execute 'edit' fnameescape(path)
      if &filetype !=# 'hyped' || b:current_syntax !=# 'hyped'
        call add(s:wrong, path . ': not taken for .hyped')
      endif
    endif
    let group = s:Group(line, start)
    if (group =~# s:WORD) != (kind ==# 'word')
      call add(s:wrong, printf('%s:%d:%d: %s %s is %s', path, line, start, kind, text, group))
    endif
  endfor
endfunction

" Other syntax: a pattern, and the expected group of its match.
function s:Groups() abort
  edit ../test/names.hyped
  for [pattern, group] in [
        \ ['\V/// Words within', 'hypedDocumentation'], ['\V// Every contextual', 'hypedComment'], ['\V"goal when"', 'hypedString'],
        \ ['\Vgoal x }', 'hypedMap'], ['\V// step', 'hypedMap'], ['\V// when', 'hypedMapComment'], ["\\V'x':", 'hypedTile'],
        \ ['\Vfollow\zs''', 'hypedPrimes'], ['\V-> map', 'hypedOperator'], ['\Vclamp(', 'hypedStatement'],
        \ ['\Vtouching(tile', 'hypedFunction'], ['\Vnear(', 'hypedFunction'], ['\Ventity \zsgoal', 'hypedItemName'],
        \ ['\V60', 'hypedNumber'], ['\Vmode \zslinks', 'hypedLabel'], ["\\V'\"': tile", '']]
    call cursor(1, 1)
    let [line, byte] = searchpos(pattern, 'cW')
    if line == 0
      if group !=# ''
        call add(s:wrong, 'nothing looks like ' . pattern)
      endif
    elseif s:Group(line, byte) !=# group
      call add(s:wrong, printf('%s is %s, not %s', pattern, s:Group(line, byte), group))
    endif
  endfor
endfunction

" Reindenting a formatted program restores it, also from no indentation.
function s:Indent() abort
  let files = glob($TIDY . '/*.hyped', 0, 1)
  if len(files) < 10
    call add(s:wrong, 'there is too little to indent')
  endif
  for file in files
    execute 'edit' fnameescape(file)
    let wanted = getline(1, '$')
    silent %s/^\s\+//e
    silent normal! gg=G
    let found = getline(1, '$')
    for at in range(len(wanted))
      if found[at] !=# wanted[at]
        call add(s:wrong, printf("%s:%d: indented as\n%s\nnot\n%s", file, at + 1, found[at], wanted[at]))
        break
      endif
    endfor
    edit!
  endfor
endfunction

" `:make` fills the quickfix list.
function s:Make() abort
  edit ../../tests/ui/dimensions.hyped
  if &makeprg !~# 'check --format short'
    call add(s:wrong, 'makeprg is ' . &makeprg)
  endif
  silent make!
  let found = filter(getqflist(), 'v:val.valid')
  let expected = systemlist($HYPEDC . ' check --format short ../../tests/ui/dimensions.hyped')
  if len(found) != len(expected) || empty(found)
    call add(s:wrong, printf('%d findings, not %d', len(found), len(expected)))
    return
  endif
  for at in range(len(found))
    let entry = found[at]
    let line = printf('../../tests/ui/dimensions.hyped:%d:%d: error[E%04d]: %s', entry.lnum, entry.col, entry.nr, entry.text)
    if line !=# expected[at] || toupper(entry.type) !=# 'E' || fnamemodify(bufname(entry.bufnr), ':t') !=# 'dimensions.hyped'
      call add(s:wrong, 'quickfix has ' . line . ', not ' . expected[at])
    endif
  endfor
endfunction

try
  let g:hypedc_path = $HYPEDC
  call s:Words()
  call s:Groups()
  call s:Indent()
  call s:Make()
catch
  call add(s:wrong, v:exception . ' at ' . v:throwpoint)
endtry

enew!
call setline(1, s:wrong + [printf('Vim: %s', empty(s:wrong) ? 'all is right' : len(s:wrong) . ' are wrong')])
%print
execute empty(s:wrong) ? 'qall!' : 'cquit!'
