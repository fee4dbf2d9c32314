;;; server.el --- Emacs and `hypedc lsp', through Eglot  -*- lexical-binding: t; -*-

;;; Commentary:

;; emacs --batch -L . -l test/server.el -f ert-run-tests-batch-and-exit
;;
;; $HYPEDC is the hypedc executable.  Eglot is that of Emacs 29, or the package (Debian's elpa-eglot).  All tests edit
;; the same copy of ../test/mistakes, in order.

;;; Code:

(require 'package)
(package-initialize)
(require 'ert)
(require 'cl-lib)
(require 'flymake)
(require 'xref)
(require 'hyped-mode)
(require 'eglot)

(setq hyped-program (getenv "HYPEDC")
      eglot-sync-connect 30
      eglot-confirm-server-initiated-edits nil
      create-lockfiles nil
      make-backup-files nil)

(defvar server--folder
  (let ((folder (file-name-as-directory (make-temp-file "hyped" t))))
    (dolist (name '("game.hyped" "slime.hyped"))
      (copy-file (expand-file-name (concat "../test/mistakes/" name)) folder))
    (let ((default-directory folder)) (call-process "git" nil nil nil "init" "-q"))
    folder))

(defun server--buffer (name)
  "The buffer of the file NAME of the program."
  (find-file-noselect (expand-file-name name server--folder)))

(defun server--checked ()
  "The findings of `hypedc check' in the files on the disk."
  (let ((default-directory server--folder))
    (sort (split-string (shell-command-to-string (concat hyped-program " check --format short game.hyped")) "\n" t)
          #'string<)))

(defun server--told (diagnostic)
  "The severity, code and message of DIAGNOSTIC in the short format."
  (let ((said (alist-get 'eglot-lsp-diag (flymake-diagnostic-data diagnostic))))
    (format "%s[%s]: %s" (if (eql (plist-get said :severity) 1) "error" "warning")
            (plist-get said :code) (car (split-string (plist-get said :message) "\n")))))

(defun server--shown ()
  "The diagnostics that Emacs shows, in the same format."
  (let ((found nil))
    (dolist (name '("game.hyped" "slime.hyped"))
      (with-current-buffer (server--buffer name)
        (dolist (diagnostic (flymake-diagnostics))
          (save-excursion
            (goto-char (flymake-diagnostic-beg diagnostic))
            (push (format "%s:%d:%d: %s" name (line-number-at-pos) (1+ (- (point) (line-beginning-position)))
                          (server--told diagnostic))
                  found)))))
    (sort found #'string<)))

(defun server--wait (what condition)
  "Wait until CONDITION holds; WHAT describes it."
  (let ((end (+ (float-time) 20)))
    (while (not (funcall condition))
      (when (> (float-time) end) (ert-fail (list 'never what)))
      (accept-process-output nil 0.02))))

(defun server--agree (count)
  "Wait until Emacs shows the COUNT findings of `hypedc check'."
  (let ((told (server--checked)) (end (+ (float-time) 20)))
    (should (= (length told) count))
    (while (and (not (equal (server--shown) told)) (< (float-time) end))
      (dolist (name '("game.hyped" "slime.hyped"))
        (with-current-buffer (server--buffer name) (flymake-start)))
      (accept-process-output nil 0.05))
    (should (equal (server--shown) told))))

(defun server--replace (name old new)
  "Replace OLD by NEW in the file NAME, and save it."
  (with-current-buffer (server--buffer name)
    (goto-char (point-min))
    (search-forward old)
    (replace-match new t t)
    (save-buffer)))

(defun server--at (name text)
  "Go to the start of TEXT in the file NAME."
  (set-buffer (server--buffer name))
  (goto-char (point-min))
  (search-forward text)
  (goto-char (match-beginning 0)))

(ert-deftest server-1-finds-what-check-finds ()
  (dolist (name '("slime.hyped" "game.hyped"))
    (with-current-buffer (server--buffer name)
      (eglot-ensure)
      (run-hooks 'post-command-hook)
      (server--wait 'a-server #'eglot-managed-p)))
  (server--agree 3))

(ert-deftest server-2-findings-go-and-come ()
  (server--replace "slime.hyped" "sise" "size")
  (server--replace "game.hyped" "Slim at" "Slime at")
  (server--replace "game.hyped" "false" "32")
  (server--agree 1))

(ert-deftest server-3-goes-to-a-definition ()
  (server--at "game.hyped" "Slime at")
  (let* ((found (xref-backend-definitions 'eglot (xref-backend-identifier-at-point 'eglot)))
         (place (xref-location-marker (xref-item-location (car found)))))
    (should (= (length found) 1))
    (should (eq (marker-buffer place) (server--buffer "slime.hyped")))
    (with-current-buffer (marker-buffer place)
      (goto-char place)
      (should (looking-at "Slime {")))))

(ert-deftest server-4-renames-in-both-files ()
  (server--at "game.hyped" "Slime at")
  (eglot-rename "Ooze")
  (server--at "game.hyped" "place second: Ooze at")
  (server--at "slime.hyped" "entity Ooze {")
  (dolist (name '("slime.hyped" "game.hyped"))
    (with-current-buffer (server--buffer name) (save-buffer)))
  (server--agree 1))

(ert-deftest server-5-lays-out ()
  (server--at "game.hyped" "      goal over")
  (eglot-format-buffer)
  (save-buffer)
  (should (equal (shell-command-to-string
                  (format "cd %s && %s fmt --check game.hyped" (shell-quote-argument server--folder) hyped-program))
                 "")))

(ert-deftest server-6-tells-what-is-at-point ()
  (server--at "game.hyped" "Ooze at")
  (let ((told nil))
    (eglot-hover-eldoc-function (lambda (text &rest _) (setq told text)))
    (server--wait 'what-is-documented (lambda () told))
    (should (string-match-p "Creeps along" told))))

;;; server.el ends here
