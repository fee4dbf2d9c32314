" Syntax highlighting of .hyped. Reserved words are keywords everywhere. Contextual keywords are recognized by the
" enclosing block and the adjacent tokens.

if exists('b:current_syntax')
  finish
endif

syn case match
syn iskeyword @,48-57,_
syn sync fromstart

" ---- expressions --------------------------------------------------------------------------------------------------

syn keyword hypedOperatorWord and or not in is as
syn keyword hypedBoolean true false
syn keyword hypedConstant none
syn keyword hypedVariable self timer
syn keyword hypedConditional when if else
syn keyword hypedStatement destroy invariant clamp
syn keyword hypedStatement use spawn nextgroup=hypedType skipwhite
syn match hypedFunction /\<\%(min\|max\|abs\|sign\|floor\|ceil\|round\|sqrt\|sin\|cos\|atan2\|mod\)\>\ze\s*(/
syn match hypedFunction /\<\%(pressed\|held\|released\|touching\|entering\|exiting\|lost\|near\|distance\|inside\|count\|received\)\>\ze\s*(/
syn match hypedOperatorWord /\<\%(any\|all\)\>\ze\s\+\%(\%(and\|or\|not\|in\|is\|as\|when\|mode\|touching\)\>\)\@!\K/ nextgroup=hypedType skipwhite
syn match hypedOperatorWord /\%([[:keyword:])']\s\+\)\@<=touching\>\ze\s*\%("\|\s\%(and\|or\|not\|in\|is\|as\|when\|mode\)\@!\K\)/
syn match hypedOperatorWord /\<nearest\>\ze\s\+\%(\%(and\|or\|not\|in\|is\|as\|when\|mode\|touching\|at\|directions\|to\|x\)\>\)\@!\K/ nextgroup=hypedType skipwhite
syn match hypedOperatorWord /\%([[:keyword:]]\s\+\)\@<=within\>\ze\s*\%((\|\s\d\|\s\%(and\|or\|not\|in\|is\|as\|when\|mode\)\@!\K\)/
syn match hypedOperatorWord /\%([[:keyword:]"]\s\+\)\@<=at\>\ze\s*(/
syn match hypedType /\%(\%(self\|when\)\>\)\@!\<\K\k*/ contained
syn match hypedPrimes /\k\@1<='\+/
syn match hypedNumber /\<\d\+\%(\.\d\+\)\?\%(frames\|ms\|s\)\?\>/
syn match hypedOperator /->\|[-+:]=\|[-+*^]\|[<>=!]=\?\|\.\./
syn match hypedOperator ,/\@1<!//\@!,
syn match hypedString /"[^"]*"/
syn match hypedComment ,//.*$, contains=hypedTodo,@Spell
syn match hypedDocumentation ,////\@!.*$, contains=hypedTodo,@Spell
syn keyword hypedTodo TODO FIXME XXX contained

syn cluster hypedExpression contains=hypedOperatorWord,hypedBoolean,hypedConstant,hypedVariable,hypedConditional,
      \hypedStatement,hypedFunction,hypedPrimes,hypedNumber,hypedOperator,hypedString,hypedComment,hypedDocumentation

" ---- items ----------------------------------------------------------------------------------------------------------

syn keyword hypedImport import
syn keyword hypedDeclaration const nextgroup=hypedIdentifier skipwhite
syn keyword hypedStructure entity behavior nextgroup=hypedItemName skipwhite skipempty
syn keyword hypedStructure world nextgroup=hypedWorldName skipwhite skipempty
syn match hypedItemName /\K\k*/ contained nextgroup=hypedFormals,hypedMembers skipwhite skipempty
syn match hypedWorldName /\K\k*/ contained nextgroup=hypedWorld skipwhite skipempty
syn region hypedFormals start=/(/ end=/)/ contained contains=hypedComment nextgroup=hypedMembers skipwhite skipempty
syn match hypedIdentifier /\K\k*/ contained

" ---- entities, groups and modes ---------------------------------------------------------------------------------------

syn region hypedMembers matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedMember
syn cluster hypedMember contains=@hypedExpression,hypedDeclaration,hypedMember,hypedModifier,hypedFollow,hypedEnvelope,hypedMembers

syn keyword hypedDeclaration param continuous ref button axis collider nextgroup=hypedIdentifier skipwhite contained
syn keyword hypedDeclaration kinematic contained
syn keyword hypedDeclaration discrete nextgroup=hypedDiscrete skipwhite contained
syn match hypedDiscrete /\K\k*/ contained nextgroup=hypedDomain
syn match hypedDomain /\s*:\s*\<\%(int\|bool\)\>/ contained contains=hypedDomainWord
syn match hypedDomain /\s*:\_s*{[^}]*}/ contained contains=hypedComment
syn match hypedDomainWord /\%(:\s*\)\@<=\%(int\|bool\)\>/ contained
syn keyword hypedMember group mode nextgroup=hypedLabel skipwhite contained
syn match hypedLabel /\K\k*/ contained
syn match hypedModifier /\<initial\>\ze\s\+\%(mode\|when\)\>/ contained
syn match hypedModifier /\<always\>\ze\s*\%({\|\/\/\|$\)/ contained
syn match hypedMember /\%(\%(^\|[{;}]\)\s*\)\@<=condition\>\ze\s\+\K\k*\s*==\@!/ contained nextgroup=hypedLabel skipwhite
syn match hypedMember /\%(\%(^\|[{;}]\)\s*\)\@<=signal\>\ze\s\+\K/ contained nextgroup=hypedIdentifier skipwhite
syn match hypedMember /\%(\%(^\|[{;}]\)\s*\)\@<=look\>\ze\s*[#"]/ contained nextgroup=hypedColor skipwhite
syn match hypedColor /#\k*/ contained
syn match hypedStatement /\%(\%(^\|[{;}]\)\s*\)\@<=send\>\ze\s\+\%(all\s\+\)\?\K\k*\./
syn match hypedDeclaration /\%(\%(^\|[{;}]\)\s*\)\@<=chance\>\ze\s\+\K\k*\s*:=\@!/ contained nextgroup=hypedIdentifier skipwhite
syn match hypedFollow /\<follow\s\+links\>\%(\s*\%('\|:\?=\)\)\@!/ contained

" The driven variable precedes `by`; it can have any name.
syn keyword hypedEnvelope envelope contained nextgroup=hypedDriven skipwhite
syn match hypedDriven /\K\k*'*\|([^)]*)/ contained contains=hypedPrimes nextgroup=hypedDriver,hypedFixed skipwhite
syn region hypedDriver matchgroup=hypedDriverWord start=/\<by\>/ end=/\ze[{}]/ contained nextgroup=hypedRamps contains=@hypedExpression,hypedDirections
syn match hypedDirections /\<directions\>\ze\s\+\k\+\s*\%({\|\/\/\|$\)/ contained
syn match hypedFixed /\<fixed\>/ contained nextgroup=hypedRamps skipwhite skipempty
syn region hypedRamps matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedExpression,hypedRamp,hypedLevel

syn match hypedRamp /\%(\%(^\|[{;]\)\s*\)\@<=\%(attack\|decay\|release\)\>\ze\s\+\K/ contained nextgroup=hypedRate skipwhite
syn match hypedRamp /\%(\%(^\|[{;]\)\s*\)\@<=sustain\>/ contained nextgroup=hypedSustained skipwhite
syn match hypedRamp /\%(\%(^\|[{;]\)\s*\)\@<=while\>\%(\s*[-+*/<>=,.)]\)\@!/ contained
syn match hypedRate /\%(accel\|over\|to\)\>/ contained nextgroup=hypedOperand skipwhite
syn match hypedRate /\%(instant\|hold\)\>/ contained
syn match hypedSustained /for\>/ contained nextgroup=hypedOperand skipwhite
syn match hypedLevel /\%([[:keyword:])']\s\+\)\@<=to\>\ze\s\+[[:keyword:](-]/ contained nextgroup=hypedOperand skipwhite
" A name after a keyword: it can look like a keyword.
syn match hypedOperand /\%(\%(not\|true\|false\|none\|self\|timer\|if\|clamp\)\>\)\@!\<\K\k*'*\%(\k\|\s*(\)\@!/ contained contains=hypedPrimes

" ---- worlds -----------------------------------------------------------------------------------------------------------

syn region hypedWorld matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedWorldItem
syn cluster hypedWorldItem contains=@hypedExpression,hypedItem,hypedColor,hypedTimes,hypedTiles,hypedSpaceWord,hypedTestWord

syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=step\>\%(\s*\%([=:.,)*/+<>]\|$\)\)\@!/ contained
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=limit\>\ze\s\+\K\k*\s\+[[:keyword:](]/ contained nextgroup=hypedType skipwhite
syn match hypedColor /\%(:\s*\)\@<=#\k*/ contained
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=look\>\ze\s\+\K\k*\s*\%(,\|:=\@!\)/ contained
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=look\>\ze\s*"[^"]*"\s*[,:]/ contained
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=player\>\ze\s\+\d/ contained
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=\%(goal\|never\)\>\ze\s\+\K\k*\s*:=\@!/ contained nextgroup=hypedLabel skipwhite
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=condition\>\ze\s\+\K\k*\s*==\@!/ contained nextgroup=hypedLabel skipwhite
syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=tiles\>\ze\s\+\K/ contained nextgroup=hypedTileSet skipwhite
syn match hypedTileSet /\K\k*/ contained nextgroup=hypedWidth skipwhite
syn match hypedWidth /\K\k*\ze\s\+x\s/ contained
syn match hypedTimes /\%([[:keyword:])]\s\+\)\@<=x\>\ze\s\+[[:keyword:](]/ contained
syn region hypedTiles matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedExpression,hypedTile,hypedTileWord,hypedTiles
syn match hypedTile /'.'\ze\s*:/ contained
syn match hypedTileWord /\%([[:keyword:]"]\s\+\)\@<=slope\>\ze\s*(/ contained
syn match hypedTileWord /\%([[:keyword:]")]\s\+\)\@<=breakable\>/ contained
syn match hypedTileWord /\%(\<breakable\s\+\)\@<=restore\s\+after\>/ contained

syn match hypedItem /\%(\%(^\|[{;}]\)\s*\)\@<=collide\>/ contained nextgroup=hypedCollide skipwhite
syn region hypedCollide keepend start=/\ze\S/ skip=/,\s*\%(\/\/.*\)\?\n/ end=/$/ end=/\ze[;}]/ contained contains=hypedWith,hypedString,hypedComment,hypedResponse
syn keyword hypedWith with contained
syn region hypedResponse start=/:/ skip=/,\s*\%(\/\/.*\)\?\n/ end=/$/ end=/\ze[;}]/ contained contains=hypedResponseWord,hypedComment
syn keyword hypedResponseWord block sense from above keep velocity carry bounce contained

" ---- tests ------------------------------------------------------------------------------------------------------------

syn match hypedTestWord /\%(\%(^\|[{;}]\)\s*\)\@<=test\>\ze\s*"/ contained nextgroup=hypedTestName skipwhite
syn match hypedTestName /"[^"]*"/ contained nextgroup=hypedTest skipwhite skipempty
syn region hypedTest matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedExpression,hypedClaim,hypedMoment
syn match hypedClaim /\%(\%(^\|[{;]\)\s*\)\@<=inputs\%(\s\+from\)\?\>\ze\s*"/ contained
syn match hypedClaim /\%(\%(^\|[{;]\)\s*\)\@<=chance\s\+seed\>/ contained
syn match hypedClaim /\%(\%(^\|[{;]\)\s*\)\@<=\%(expect\|reachable\|unreachable\|unfound\|never\)\>/ contained
syn match hypedMoment /\%([[:keyword:])'"]\s\+\)\@<=\%(at\|by\)\>\%(\s\+end\>\)\?/ contained
syn match hypedMoment /\%([[:keyword:])'"]\s\+\)\@<=\%(always\|never\)\>\ze\s*\%([;}]\|\/\/\|$\)/ contained
syn match hypedMoment /\%([[:keyword:])'"]\s\+\)\@<=\%(without\|within\)\>/ contained

" ---- spaces -----------------------------------------------------------------------------------------------------------

syn match hypedSpaceWord /\%(\%(^\|[{;}]\)\s*\)\@<=space\>\ze\s\+\K/ contained nextgroup=hypedSpaceName skipwhite
syn match hypedSpaceName /\K\k*/ contained nextgroup=hypedSpace skipwhite skipempty
syn region hypedSpace matchgroup=hypedBrace start=/{/ end=/}/ contained fold contains=@hypedExpression,hypedPlace,hypedMapWord,hypedMap,hypedTimes,hypedTiles

syn match hypedPlace /\%(\%(^\|[{;}]\)\s*\)\@<=place\>\ze\s\+\K\k*\s*:/ contained
syn match hypedPlace /\%(:\s*\K\k*\s\+\)\@<=at\>\ze\s*(/ contained
syn match hypedPlace /\%(,\s*\)\@<=above\>\ze\s*\%("\|\K\)/ contained
syn match hypedPlace /\%(\%(^\|[{;}]\)\s*\)\@<=\%(link\|bounds\)\s\+rect\>/ contained
syn match hypedPlace /\%(\%(^\|[{;}]\)\s*\)\@<=wrap\>\ze\s\+\K/ contained
syn match hypedPlace /\%(->\s*\K\k*\s\+\)\@<=at\s\+rect\>/ contained
syn match hypedPlace /\%(\%(^\|[{;}]\)\s*\)\@<=rect\>/ contained

syn match hypedMapWord /\%(\%(^\|[{;}]\)\s*\)\@<=map\>/ contained
syn match hypedMapWord /\%(\<map\s\+\)\@<=\%(vglc\|tiled\|ldtk\)\>\ze\s*"[^"]\+"/ contained
syn match hypedMapWord /\%(\<map\s\+\)\@<=level\s\+legend\>\ze\s*"/ contained
syn match hypedMapWord /\%(\<map\s\+\)\@<=level\>\ze\s\+\%(\%(from\|legend\)\s*"\)\@!\K/ contained nextgroup=hypedIdentifier skipwhite
syn match hypedMapWord /\%(\<map\s\+\K\k*\s\+\)\@<=from\>\ze\s*"/ contained
syn match hypedMapWord /\%(\<map\s\+\)\@<=level\>\ze\s*\%([;{}]\|\/\/\|$\)/ contained
syn match hypedMapWord /\%("\s*\)\@<=\<level\>\ze\s*"/ contained
syn match hypedMapWord /\%("\s\+\)\@<=legend\>\ze\s*"/ contained
syn match hypedMapWord /\%("\s\+\)\@<=tile\>/ contained nextgroup=hypedWidth skipwhite
syn region hypedMap start=/"\ze\s*\%(\/\/.*\)\?$/ end=/"/ contained fold contains=hypedMapComment
syn match hypedMapComment /\%("\s*\)\@<=\/\/.*$/ contained

hi def link hypedComment Comment
hi def link hypedMapComment Comment
hi def link hypedDocumentation SpecialComment
hi def link hypedTodo Todo
hi def link hypedString String
hi def link hypedMap String
hi def link hypedTile Character
hi def link hypedNumber Number
hi def link hypedBoolean Boolean
hi def link hypedConstant Constant
hi def link hypedVariable Special
hi def link hypedFunction Function
hi def link hypedOperator Operator
hi def link hypedPrimes Operator
hi def link hypedOperatorWord Keyword
hi def link hypedConditional Conditional
hi def link hypedStatement Statement
hi def link hypedFollow Statement
hi def link hypedImport Include
hi def link hypedStructure Structure
hi def link hypedSpaceWord Structure
hi def link hypedMember Structure
hi def link hypedColor Constant
hi def link hypedModifier StorageClass
hi def link hypedDeclaration StorageClass
hi def link hypedDomainWord Type
hi def link hypedEnvelope Statement
hi def link hypedDriverWord Statement
hi def link hypedDirections Statement
hi def link hypedFixed Statement
hi def link hypedRamp Statement
hi def link hypedRate Statement
hi def link hypedSustained Statement
hi def link hypedLevel Statement
hi def link hypedItem Statement
hi def link hypedTestWord Structure
hi def link hypedTestName Label
hi def link hypedClaim Statement
hi def link hypedMoment Keyword
hi def link hypedTimes Statement
hi def link hypedWith Statement
hi def link hypedTileWord Keyword
hi def link hypedResponseWord StorageClass
hi def link hypedPlace Statement
hi def link hypedMapWord Statement
hi def link hypedType Type
hi def link hypedItemName Type
hi def link hypedWorldName Identifier
hi def link hypedSpaceName Identifier
hi def link hypedIdentifier Identifier
hi def link hypedDiscrete Identifier
hi def link hypedLabel Label

let b:current_syntax = 'hyped'
