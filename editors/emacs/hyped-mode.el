;;; hyped-mode.el --- Major mode for .hyped, game entities as hybrid automata  -*- lexical-binding: t; -*-

;; SPDX-License-Identifier: MIT OR Apache-2.0
;; Version: 0.1.0
;; Package-Requires: ((emacs "27.1"))
;; Keywords: languages

;;; Commentary:

;; Syntax highlighting, indentation as by `hypedc fmt', imenu, `compile' with `hypedc check', and the language server
;; `hypedc lsp' through Eglot: M-x eglot in a buffer of this mode.

;;; Code:

(require 'compile)
(require 'cl-lib)

(defgroup hyped nil
  "Programs of game entities as hybrid automata."
  :group 'languages)

(defcustom hyped-program "hypedc"
  "The hypedc executable: a command on the PATH, or a path."
  :type 'string)

(defcustom hyped-indent-offset 4
  "The indentation of a block.  `hypedc fmt' always uses 4."
  :type 'integer
  :safe #'integerp)

(defvar hyped-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?_ "w" table)
    (modify-syntax-entry ?/ ". 12" table)
    (modify-syntax-entry ?\n ">" table)
    (modify-syntax-entry ?\r ">" table)
    (modify-syntax-entry ?\" "\"" table)
    (modify-syntax-entry ?\\ "." table)
    (dolist (sign '(?' ?+ ?- ?* ?< ?> ?= ?! ?^ ?. ?: ?, ?\; ?& ?| ?% ?$ ?# ?`))
      (modify-syntax-entry sign "." table))
    (dolist (sign '(?\[ ?\]))
      (modify-syntax-entry sign "." table))
    table)
  "Syntax table of .hyped.  An inline map is a string over several lines.")

(defconst hyped--syntax-propertize
  (syntax-propertize-rules
   ;; The character of a tile is no delimiter.
   ("'\\(.\\)'[ \t]*:" (1 "."))))

;; ---- words: reserved ones, and those that are words only where the grammar looks for them ----------------------------

(defconst hyped--reserved-words
  '("and" "or" "not" "in" "is" "as" "if" "param" "continuous" "discrete" "ref" "button" "axis" "collider" "kinematic"
    "clamp" "invariant" "group" "mode" "when" "else" "envelope" "use" "spawn" "destroy" "entity" "behavior" "world"
    "import" "const"))

(defconst hyped--constants '("true" "false" "none"))

(defconst hyped--variables '("self" "timer"))

(defconst hyped--functions
  '("min" "max" "abs" "sign" "clamp" "floor" "ceil" "round" "sqrt" "sin" "cos" "atan2" "mod" "if" "pressed" "held" "released"
    "touching" "timer" "entering" "exiting" "lost" "near" "distance" "inside" "count" "received"))

;; Each is (BLOCK PIECE...): the kind of the enclosing block, or `any', and the pieces of a pattern whose groups are
;; keywords.
(defconst hyped--words
  '((any "\\_<\\(any\\)[ \t]+" free)
    (any "\\_<\\(all\\)[ \t]+" free)
    (members "\\_<\\(nearest\\)[ \t]+" free)
    (members "\\w[ \t]+\\(within\\)[ \t]+[([:word:]]")
    (any operand "\\(touching\\)\\(?:[ \t]*\"\\|[ \t]+" tag "\\)")
    (members "[\"[:word:]][ \t]+\\(at\\)[ \t]*(")
    (members "\\_<\\(initial\\)[ \t]+\\(?:mode\\|when\\)\\_>")
    (members "\\_<\\(always\\)[ \t\n]*{")
    (members "\\_<\\(follow\\)[ \t]+\\(links\\)\\_>[ \t]*\\(?:[^':= \t]\\|$\\)")
    (members start "\\(condition\\)[ \t]+" name "[ \t]*=\\(?:[^=]\\|$\\)")
    (members start "\\(signal\\)[ \t]+" name)
    (members start "\\(look\\)[ \t]*[#\"]")
    (members start "\\(send\\)[ \t]+\\(?:\\(all\\)[ \t]+\\)?" name "[.]")
    (members start "\\(chance\\)[ \t]+" name "[ \t]*:\\(?:[^=]\\|$\\)")
    (members "\\_<discrete[ \t]+" name "[ \t]*:[ \t]*\\(int\\|bool\\)\\_>")
    (members "\\_<envelope[ \t]+\\(?:" name "'*\\|([^)]*)\\)[ \t]+\\(by\\|fixed\\)\\_>")
    (members "\\_<\\(directions\\)[ \t]+\\w+[ \t]*\\(?:{\\|//\\|$\\)")
    (ramps start "\\(attack\\|decay\\|release\\)[ \t]+\\(?:\\(instant\\|hold\\)\\|\\(accel\\|over\\|to\\)\\)\\_>")
    (ramps start "\\(?:attack\\|release\\)[ \t]+\\(?:accel\\|over\\)[ \t]+\\(?:to[ \t]+\\|.*?[]')_[:alnum:]][ \t]+\\)\\(to\\)[ \t]+[-([:word:]]")
    (ramps start "\\(attack\\|decay\\|release\\)[ \t]+\\w")
    (ramps start "\\(sustain\\)\\_>\\(?:[ \t]+\\(for\\)\\_>\\)?")
    (ramps start "\\(while\\)\\_>[ \t]*\\(?:[^-+*/<>=,.) \t]\\|$\\)")
    (world start "\\(step\\)[ \t]+[^=:.,)*/+<> \t]")
    (world start "\\(collide\\)\\_>")
    (world "\\_<collide[ \t]+[^:\n]*[\"[:word:]][ \t]+\\(with\\)\\_>")
    (world "\\_<collide\\_>[^:\n]*:[ \t]*\\(block\\|sense\\)\\_>\\(?:[ \t]+\\(from\\)[ \t]+\\(above\\)\\_>\\)?")
    (world "\\_<with\\_>[^:\n]*:.*?\\_<\\(keep\\)[ \t]+\\(velocity\\)\\_>")
    (world "\\_<with\\_>[^:\n]*:.*?\\_<\\(carry\\)\\_>")
    (world "\\_<with\\_>[^:\n]*:.*?\\_<\\(bounce\\)\\_>")
    (world "^[ \t]+[[:word:]\", ]*[\"[:word:]][ \t]+\\(with\\)[ \t]+[[:word:]\", ]*:[ \t]*\\(block\\|sense\\)\\_>")
    (world start "\\(tiles\\|space\\)[ \t]+\\w")
    (world start "\\(limit\\)[ \t]+" name "[ \t]+[([:word:]]")
    (world start "\\(look\\)\\(?:[ \t]+" name "\\|[ \t]*\"[^\"\n]*\"\\)[ \t]*\\(?:,\\|:[^=]\\)")
    (world start "\\(player\\)[ \t]+[0-9]")
    (world start "\\(goal\\|never\\)[ \t]+" name "[ \t]*:\\(?:[^=]\\|$\\)")
    (world start "\\(condition\\)[ \t]+" name "[ \t]*=\\(?:[^=]\\|$\\)")
    (world start "tiles[ \t]+" name "[ \t]+\\(?:x[ \t]+\\|[^{\n]*?[)[:word:]][ \t]+\\)\\(x\\)[ \t]+[([:word:]]")
    (inner ":[ \t]*[^:;\n]*[\"[:word:]][ \t]+\\(slope\\)[ \t]*(")
    (inner ":[ \t]*[^:;\n]*[\")[:word:]][ \t]+\\(breakable\\)\\_>\\(?:[ \t]+\\(restore\\)[ \t]+\\(after\\)\\_>\\)?")
    (space start "\\(place\\)[ \t]+" name "[ \t]*:[ \t]*" name "[ \t]+\\(at\\)\\_>")
    (space ",[ \t]*\\(above\\)\\(?:[ \t]*\"\\|[ \t]+" name "\\)")
    (space start "\\(link\\|bounds\\)[ \t]+\\(rect\\)\\_>")
    (world start "\\(test\\)[ \t]*\"")
    (claims start "\\(inputs\\)\\(?:[ \t]+\\(from\\)\\)?[ \t]*\"")
    (claims start "\\(chance\\)[ \t]+\\(seed\\)\\_>")
    (claims start "\\(expect\\|reachable\\|unreachable\\|unfound\\|never\\)\\_>")
    (claims operand "\\(at\\|by\\)[ \t]+\\(?:\\(end\\)\\_>\\|[([:word:]]\\)")
    (claims operand "\\(always\\|never\\)[ \t]*\\(?:[;}]\\|//\\|$\\)")
    (claims operand "\\(without\\|within\\)[ \t]+[([:word:]]")
    (space start "\\(wrap\\)[ \t]+\\w")
    (space "->[ \t]*" name "[ \t]+\\(at\\)[ \t]+\\(rect\\)\\_>")
    (space start "\\(rect\\)\\_>")
    (space start "\\(map\\)\\_>")
    (space start "map[ \t]+\\(vglc\\|tiled\\|ldtk\\)[ \t]*\"[^\"\n]+\"")
    (space start "map[ \t]+\\(level\\)[ \t]+\\(legend\\)[ \t]*\"")
    (space start "map[ \t]+\\(level\\)[ \t]+" name "\\_>[ \t]*\\(?:[^\" \t]\\|$\\)")
    (space start "map[ \t]+\\(level\\)[ \t]*\\(?:[;{}]\\|//\\|$\\)")
    (space start "map[ \t]+ldtk[ \t]*\"[^\"\n]+\"[ \t]*\\(level\\)[ \t]*\"")
    (space start "map[ \t]+" name "[ \t]+\\(from\\)[ \t]*\"")
    (space start "map[ \t]+vglc[ \t]+\"[^\"\n]+\"[ \t]+\\(legend\\)\\_>")
    (space start "map[ \t]+.*\"[^\"\n]*\"[ \t]+\\(tile\\)[ \t]+\\(?:x[ \t]+\\|[^{\n]*?[)[:word:]][ \t]+\\)\\(x\\)[ \t]+[([:word:]]")))

;; ---- end of words ----------------------------------------------------------------------------------------------------

(defconst hyped--name "\\_<[[:alpha:]_]\\w*")

(defconst hyped--start "\\(?:^\\|[;{}]\\)[ \t]*"
  "The text before a statement.")

(defun hyped--pattern (pieces)
  "The regular expression of PIECES."
  (mapconcat
   (lambda (piece)
     (pcase piece
       ('name hyped--name)
       ('start hyped--start)
       ('operand "[)'[:word:]][ \t]+")
       ;; The first letter of a name; `hyped--free-p' checks that it is no keyword.
       ((or 'free 'tag) "\\w")
       (_ piece)))
   pieces ""))

(defun hyped--free-p (piece)
  "Whether the word at the end of the match is no keyword, for the kind PIECE."
  (save-excursion
    (goto-char (1- (match-end 0)))
    (let ((case-fold-search nil))
      (and (looking-at "[[:alpha:]_]")
           (not (looking-at (regexp-opt (append '("true" "false" "none" "self" "timer")
                                                (and (eq piece 'free) '("touching"))
                                                hyped--reserved-words)
                                        'symbols)))))))

(defconst hyped--headers
  '(("world" . world) ("test" . claims) ("space" . space) ("tiles" . inner) ("place" . inner) ("map" . inner) ("envelope" . ramps)
    ("entity" . members) ("behavior" . members) ("group" . members) ("mode" . members) ("initial" . members)
    ("always" . members)
    ("when" . members) ("else" . members) ("follow" . members)))

(defun hyped--block (position)
  "The kind of the block around POSITION, or nil."
  (save-excursion
    (save-match-data
      (let* ((case-fold-search nil)
             (open (cl-find ?{ (reverse (nth 9 (syntax-ppss position))) :key #'char-after)))
        (when open
          (goto-char open)
          (let ((kind nil))
            (while (and (not kind)
                        (re-search-backward (concat hyped--start "\\(" (regexp-opt (mapcar #'car hyped--headers)) "\\)\\_>") nil 'move))
              (unless (nth 8 (syntax-ppss (match-beginning 1)))
                (setq kind (cdr (assoc (match-string 1) hyped--headers)))))
            kind))))))

(defun hyped--matcher (block pieces)
  "A function for `font-lock-keywords' that searches for PIECES in a BLOCK."
  (let ((pattern (hyped--pattern pieces))
        (last-piece (car (last pieces)))
        (tag (memq 'tag pieces)))
    (lambda (limit)
      (let ((case-fold-search nil) (found nil))
        (while (and (not found) (re-search-forward pattern limit t))
          (let ((next (max (or (match-end 1) 0) (or (match-end 2) 0) (1+ (match-beginning 0)))))
            (setq found (and (not (nth 8 (save-match-data (syntax-ppss (or (match-beginning 1) (match-beginning 2))))))
                             (or (eq block 'any) (eq block (hyped--block (or (match-beginning 1) (match-beginning 2)))))
                             (or (not (eq last-piece 'free)) (save-match-data (hyped--free-p 'free)))
                             (or (not tag) (eq (char-before (match-end 0)) ?\") (save-match-data (hyped--free-p 'tag)))))
            ;; The end of a match can be the start of the next one.
            (goto-char (min next limit))))
        found))))

(defun hyped--groups (pieces)
  "The number of groups in the pattern of PIECES."
  (regexp-opt-depth (hyped--pattern pieces)))

(defun hyped--match-function (limit)
  "Search for a call of a built-in function up to LIMIT.
Skips the tag before the parenthesis of a `rect' in a space."
  (let ((case-fold-search nil) (found nil))
    (while (and (not found)
                (re-search-forward (concat (regexp-opt hyped--functions 'symbols) "[ \t]*(") limit t))
      (setq found (save-match-data
                    (save-excursion
                      (goto-char (match-beginning 0))
                      (not (looking-back (concat hyped--start "rect[ \t]+[^(\n]*") (line-beginning-position)))))))
    found))

(defconst hyped-font-lock-keywords
  `((hyped--match-function 1 font-lock-builtin-face)
    (,(regexp-opt hyped--reserved-words 'symbols) . font-lock-keyword-face)
    (,(regexp-opt hyped--constants 'symbols) . font-lock-constant-face)
    (,(regexp-opt hyped--variables 'symbols) . font-lock-builtin-face)
    ,@(mapcar
       (lambda (word)
         `(,(hyped--matcher (car word) (cdr word))
           ,@(mapcar (lambda (group) `(,group font-lock-keyword-face t t))
                     (number-sequence 1 (hyped--groups (cdr word))))))
       hyped--words)
    ("\\_<\\(?:entity\\|ref[ \t]+\\w+[ \t]*:\\|spawn\\|use\\|is\\)[ \t]+\\([[:alpha:]_]\\w*\\)" 1 font-lock-type-face)
    ("\\_<\\(?:behavior\\|world\\)[ \t]+\\([[:alpha:]_]\\w*\\)" 1 font-lock-function-name-face)
    ("\\_<\\(?:mode\\|group\\)[ \t]+\\([[:alpha:]_]\\w*\\)" 1 font-lock-function-name-face)
    ("\\_<\\(?:const\\|param\\|continuous\\|discrete\\|ref\\)[ \t]+\\([[:alpha:]_]\\w*\\)" 1 font-lock-variable-name-face)
    ("\\('.'\\)[ \t]*:" 1 font-lock-string-face)))

(defun hyped--syntactic-face (state)
  "The face of a string or comment, given the parser STATE."
  (cond ((nth 3 state) font-lock-string-face)
        ((save-excursion (goto-char (nth 8 state)) (looking-at "///\\(?:[^/]\\|$\\)")) font-lock-doc-face)
        (t font-lock-comment-face)))

;; ---- indentation -----------------------------------------------------------------------------------------------------

(defun hyped--indentation-at (position)
  "The indentation of the line of POSITION."
  (save-excursion (goto-char position) (current-indentation)))

(defun hyped--goes-on-p ()
  "Whether the line at point continues the preceding statement."
  (let ((case-fold-search nil))
    (or (save-excursion
          (forward-comment (- (point)))
          (or (memq (char-before) (string-to-list "-+*/<>=,:"))
              (and (looking-back "\\_<\\(?:and\\|or\\|not\\)" (line-beginning-position)) t)))
        (save-excursion
          (forward-comment (point-max))
          (looking-at "\\(?:and\\|or\\)\\_>\\|->")))))

(defun hyped--indentation ()
  "The indentation of the line at point, as by `hypedc fmt'."
  (save-excursion
    (beginning-of-line)
    (let* ((state (syntax-ppss))
           (open (nth 1 state)))
      (skip-chars-forward " \t")
      (cond
       ;; The rows of a map, and its closing quote.
       ((nth 3 state)
        (+ (hyped--indentation-at (nth 8 state)) (if (eq (char-after) ?\") 0 hyped-indent-offset)))
       ((memq (char-after) '(?\) ?}))
        (if open (hyped--indentation-at open) 0))
       (t
        (let ((here (if open (+ (hyped--indentation-at open) hyped-indent-offset) 0)))
          (if (or (eq (char-after) ?{)
                  (and open (eq (char-after open) ?\())
                  ;; The values of a discrete variable.
                  (and open (save-excursion (goto-char open) (forward-comment (- (point))) (eq (char-before) ?:)))
                  (not (hyped--goes-on-p)))
              here
            (+ here hyped-indent-offset))))))))

(defun hyped-indent-line ()
  "Indent the line at point as `hypedc fmt' does."
  (interactive)
  (let ((column (hyped--indentation)))
    (if (<= (current-column) (current-indentation))
        (indent-line-to column)
      (save-excursion (indent-line-to column)))))

;; ---- the mode --------------------------------------------------------------------------------------------------------

(defconst hyped--imenu
  '(("Entities" "^entity[ \t]+\\(\\w+\\)" 1)
    ("Behaviours" "^behavior[ \t]+\\(\\w+\\)" 1)
    ("Worlds" "^world[ \t]+\\(\\w+\\)" 1)
    ("Modes" "^[ \t]+\\(?:initial[ \t]+\\(?:when.*\\)?\\)?mode[ \t]+\\(\\w+\\)" 1)
    ("Conditions" "^[ \t]+condition[ \t]+\\(\\w+\\)[ \t]*=" 1)
    ("Goals" "^[ \t]+\\(?:goal\\|never\\)[ \t]+\\(\\w+\\)[ \t]*:" 1)))

(add-to-list 'compilation-error-regexp-alist-alist
             '(hypedc "^\\(.+?\\):\\([0-9]+\\):\\([0-9]+\\): \\(?:error\\|\\(warning\\)\\)\\[[EW][0-9]+\\]: " 1 2 3 (4)))
(add-to-list 'compilation-error-regexp-alist 'hypedc)

(defvar eglot-server-programs)

(defun hyped--server (&rest _)
  "The command line of the language server."
  (list hyped-program "lsp"))

;;;###autoload
(define-derived-mode hyped-mode prog-mode "Hyped"
  "Major mode for .hyped, game entities as hybrid automata."
  (setq-local comment-start "// ")
  (setq-local comment-end "")
  (setq-local comment-start-skip "///?[ \t]*")
  (setq-local parse-sexp-lookup-properties t)
  (setq-local syntax-propertize-function hyped--syntax-propertize)
  (setq-local font-lock-defaults
              '(hyped-font-lock-keywords nil nil nil (font-lock-syntactic-face-function . hyped--syntactic-face)))
  (setq-local indent-line-function #'hyped-indent-line)
  (setq-local indent-tabs-mode nil)
  (setq-local tab-width hyped-indent-offset)
  (setq-local electric-indent-chars (append '(?} ?\)) electric-indent-chars))
  (setq-local imenu-generic-expression hyped--imenu)
  (when buffer-file-name
    (setq-local compile-command
                (concat hyped-program " check --format short " (shell-quote-argument (file-relative-name buffer-file-name))))))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.hyped\\'" . hyped-mode))

(with-eval-after-load 'eglot
  (add-to-list 'eglot-server-programs (cons 'hyped-mode #'hyped--server)))

(provide 'hyped-mode)

;;; hyped-mode.el ends here
