;;; run.el --- Tests of hyped-mode, in batch  -*- lexical-binding: t; -*-

;;; Commentary:

;; emacs -Q --batch -L . -l test/run.el -f ert-run-tests-batch-and-exit
;;
;; $WORDS is the output of editors/test/words.mjs, $TIDY a folder of programs formatted by `hypedc fmt', $HYPEDC the
;; hypedc executable.

;;; Code:

(require 'ert)
(require 'hyped-mode)

(defconst run--words '(font-lock-keyword-face font-lock-constant-face font-lock-builtin-face))

(defun run--lines (path)
  "The lines of the file PATH."
  (with-temp-buffer
    (insert-file-contents path)
    (split-string (buffer-string) "\n" t)))

(defmacro run--with-file (path &rest body)
  "Run BODY in a fontified buffer with the file PATH, in the mode that Emacs selects for it."
  (declare (indent 1))
  `(with-current-buffer (find-file-noselect ,path)
     (unwind-protect
         (progn (should (eq major-mode 'hyped-mode)) (font-lock-ensure) ,@body)
       (set-buffer-modified-p nil)
       (kill-buffer))))

(ert-deftest run-words-are-words-and-names-are-names ()
  "Keywords and names are those of the tree-sitter grammar."
  (let ((files (make-hash-table :test #'equal)) (paths nil) (wrong nil) (rows (run--lines (getenv "WORDS"))))
    (should (> (length rows) 10000))
    (dolist (row rows)
      (let ((fields (split-string row "\t")))
        (unless (gethash (car fields) files) (push (car fields) paths))
        (push fields (gethash (car fields) files))))
    (dolist (path (nreverse paths))
      (run--with-file path
        (let ((at 1))
          (dolist (fields (nreverse (gethash path files)))
            (pcase-let ((`(,_ ,line ,start ,_ ,kind ,text) fields))
              (forward-line (- (string-to-number line) at))
              (setq at (string-to-number line))
              (let* ((position (byte-to-position (+ (position-bytes (point)) -1 (string-to-number start))))
                     (face (get-text-property position 'face)))
                (unless (eq (and (memq face run--words) t) (equal kind "word"))
                  (message "%s:%s:%s: %s %s is %s" path line start kind text face)
                  (setq wrong t))))))))
    (should-not wrong)))

(ert-deftest run-colours ()
  "Strings, maps, tiles, comments, functions, types."
  (with-temp-buffer
    (insert "/// doc\n// comment\n//// comment\nentity Hero {\n    x' = near(a) + 1\n}\nworld W {\n    tiles t 1 x 1 {\n"
            "        '\"': wall // tile\n    }\n    space s {\n        map t \"\n            when//}\n        \"\n    }\n}\n")
    (hyped-mode)
    (font-lock-ensure)
    (pcase-dolist (`(,text ,face) '(("/// doc" font-lock-doc-face) ("// comment" font-lock-comment-delimiter-face)
                                    ("comment" font-lock-comment-face) ("//// comment" font-lock-comment-delimiter-face)
                                    ("Hero" font-lock-type-face) ("near" font-lock-builtin-face) ("W" font-lock-function-name-face)
                                    ("'\"'" font-lock-string-face) ("wall" nil) ("tile\n" font-lock-comment-face)
                                    ("when//" font-lock-string-face) ("}\n        \"" font-lock-string-face)))
      (goto-char (point-min))
      (let ((case-fold-search nil)) (search-forward text))
      (should (equal (list text (get-text-property (match-beginning 0) 'face)) (list text face))))))

(ert-deftest run-indentation ()
  "Reindenting a formatted program restores it, also from no indentation."
  (let ((files (directory-files (getenv "TIDY") t "\\.hyped\\'")) (wrong nil))
    (should (> (length files) 10))
    (dolist (path files)
      (run--with-file path
        (let ((wanted (buffer-string)))
          (goto-char (point-min))
          (while (re-search-forward "^[ \t]+" nil t) (replace-match ""))
          (let ((inhibit-message t)) (indent-region (point-min) (point-max)))
          (let ((found (buffer-string)))
            (unless (equal found wanted)
              (let ((at (cl-mismatch found wanted)))
                (goto-char (1+ at))
                (push (format "%s:%d: %s" path (line-number-at-pos) (buffer-substring (line-beginning-position) (line-end-position)))
                      wrong)))))))
    (should (equal (nreverse wrong) nil))))

(ert-deftest run-compilation ()
  "Findings become locations."
  (let* ((default-directory (file-name-directory (locate-library "hyped-mode")))
         (path (expand-file-name "../../tests/ui/dimensions.hyped"))
         (command (concat (getenv "HYPEDC") " check --format short " path))
         (expected (length (split-string (shell-command-to-string command) "\n" t)))
         (buffer (let ((inhibit-message t)) (compilation-start command))))
    (while (get-buffer-process buffer) (accept-process-output nil 0.05))
    (with-current-buffer buffer
      (compilation--ensure-parse (point-max))
      (goto-char (point-min))
      (let ((places nil) (match nil))
        (while (setq match (text-property-search-forward 'compilation-message))
          (let ((location (compilation--message->loc (prop-match-value match))))
            (push (cons (caar (compilation--loc->file-struct location)) (compilation--loc->line location)) places)))
        (should (> expected 0))
        (should (= (length places) expected))
        (should (cl-every (lambda (place) (equal (car place) path)) places))))))

(ert-deftest run-server ()
  "The server is registered with Eglot."
  (unless (require 'eglot nil t)
    ;; Emacs before 29 lacks Eglot: provide the feature, to test the code that runs after its load.
    (defvar eglot-server-programs nil)
    (provide 'eglot))
  (let ((hyped-program "/a/hypedc"))
    (should (equal (funcall (cdr (assq 'hyped-mode eglot-server-programs)) nil) '("/a/hypedc" "lsp")))))

;;; run.el ends here
