" Indents .hyped as `hypedc fmt` does: one level per open block, and one for continuation lines.

if exists('b:did_indent')
  finish
endif
let b:did_indent = 1

setlocal indentexpr=HypedIndent(v:lnum)
setlocal indentkeys=0{,0},0),0\",!^F,o,O,0=and,0=or,0=->
let b:undo_indent = 'setlocal indentexpr< indentkeys<'

if exists('*HypedIndent')
  finish
endif

" A line without strings, characters of tiles and comments. A remaining quote starts or ends a map.
function s:Code(line) abort
  let code = substitute(a:line, '"[^"]*"\|''.''\ze\s*:\|//.*$', '\=submatch(0)[0] ==# "/" ? "" : "0"', 'g')
  return substitute(code, '\s\+$', '', '')
endfunction

" The first line of the item that contains a line; the lines before it do not matter.
function s:Item(lnum) abort
  let at = prevnonblank(a:lnum - 1)
  while at > 1 && getline(at) !~# '^\%(entity\|behavior\|world\|import\|const\)\>'
    let at -= 1
  endwhile
  return max([at, 1])
endfunction

" Whether the first non-blank line of code from here on continues the preceding statement.
function s:GoesOn(lnum) abort
  let at = a:lnum
  while at <= line('$') && s:Code(getline(at)) =~# '^\s*$'
    let at += 1
  endwhile
  return getline(at) =~# '^\s*\%(\%(and\|or\)\>\|->\)'
endfunction

function HypedIndent(lnum) abort
  " The open brackets: the indentation of their lines, and whether they list names, which continue after commas.
  let open = []
  let last = ''
  let map = -1
  for at in range(s:Item(a:lnum), a:lnum - 1)
    let line = getline(at)
    if map >= 0
      if line =~# '^\s*"'
        let map = -1
        let last = '"'
      endif
      continue
    endif
    let code = s:Code(line)
    if code =~# '^\s*$'
      continue
    endif
    let from = 0
    while 1
      let [bracket, from, next] = matchstrpos(code, '[(){}]', from)
      if from < 0
        break
      elseif bracket =~# '[({]'
        let before = strpart(code, 0, from) =~# '\S' ? strpart(code, 0, from) : last
        call add(open, [bracket, indent(at), bracket ==# '{' && before =~# ':\s*$'])
      elseif !empty(open)
        call remove(open, -1)
      endif
      let from = next
    endwhile
    let last = code
    if code =~# '"$'
      let map = indent(at)
    endif
  endfor

  let line = getline(a:lnum)
  if map >= 0
    return line =~# '^\s*"' ? map : map + shiftwidth()
  endif
  let [bracket, depth, names] = empty(open) ? ['', -shiftwidth(), 0] : open[-1]
  if line =~# '^\s*[)}]'
    return max([depth, 0])
  endif
  let here = depth + shiftwidth()
  if bracket ==# '(' || names || line =~# '^\s*{'
    return here
  endif
  let goes_on = last =~# '\%([-+*/<>=,:]\|\<\%(and\|or\|not\)\)$' || s:GoesOn(a:lnum)
  return goes_on ? here + shiftwidth() : here
endfunction
