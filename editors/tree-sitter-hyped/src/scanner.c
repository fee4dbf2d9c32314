// The external scanner, for tokens that depend on context: line breaks that end statements, and rows of inline maps.
//
// A line break ends a statement unless the next line continues it with an operator, `->` or `{`, none of which can start
// a statement. Inside parentheses, and after an operator or a comma, the parser does not accept this token. The scanner
// has no state.

#include "tree_sitter/parser.h"

enum Token { NEWLINE, MAP_START, MAP_ROW, RECOVERING };

static bool is_blank(int32_t c) { return c == ' ' || c == '\t'; }

static bool is_break(int32_t c) { return c == '\n' || c == '\r'; }

static bool at_end_of_line(TSLexer *lexer) { return is_break(lexer->lookahead) || lexer->eof(lexer); }

// Whether a character can continue a word: a letter (also beyond ASCII), a digit or `_`.
static bool is_name_char(int32_t c) {
    return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c > 127;
}

static void to_end_of_line(TSLexer *lexer) {
    while (!at_end_of_line(lexer)) lexer->advance(lexer, false);
}

static bool is_word(TSLexer *lexer, const char *word) {
    for (; *word; word++) {
        if (lexer->lookahead != *word) return false;
        lexer->advance(lexer, false);
    }
    return !is_name_char(lexer->lookahead);
}

// Whether the next token, after blank lines and comments, continues the statement.
static bool goes_on(TSLexer *lexer) {
    for (;;) {
        while (is_blank(lexer->lookahead) || is_break(lexer->lookahead)) lexer->advance(lexer, false);
        if (lexer->lookahead != '/') break;
        lexer->advance(lexer, false);
        if (lexer->lookahead != '/') return true;
        to_end_of_line(lexer);
    }
    switch (lexer->lookahead) {
        case '{': return true;
        case '+': case '-': case '*': case '<': case '>': return true;
        case '=': case '!': lexer->advance(lexer, false); return lexer->lookahead == '=';
        case 'a': return is_word(lexer, "and");
        case 'o': return is_word(lexer, "or");
        default: return false;
    }
}

static bool newline(TSLexer *lexer) {
    while (is_blank(lexer->lookahead)) lexer->advance(lexer, true);
    // A comment before the line break is a node: the lexer consumes it, then calls the scanner again.
    if (!is_break(lexer->lookahead)) return false;
    bool returned = lexer->lookahead == '\r';
    lexer->advance(lexer, false);
    if (returned && lexer->lookahead == '\n') lexer->advance(lexer, false);
    lexer->mark_end(lexer);
    lexer->result_symbol = NEWLINE;
    return !goes_on(lexer);
}

// The opening quote of a map: at most a comment follows it in the line.
static bool map_start(TSLexer *lexer) {
    while (is_blank(lexer->lookahead) || is_break(lexer->lookahead)) lexer->advance(lexer, true);
    if (lexer->lookahead != '"') return false;
    lexer->advance(lexer, false);
    lexer->mark_end(lexer);
    lexer->result_symbol = MAP_START;
    while (is_blank(lexer->lookahead)) lexer->advance(lexer, false);
    if (is_break(lexer->lookahead)) return true;
    for (int slash = 0; slash < 2; slash++) {
        if (lexer->lookahead != '/') return false;
        lexer->advance(lexer, false);
    }
    to_end_of_line(lexer);
    return is_break(lexer->lookahead);
}

// A row, from its first cell to its last one. A row has its own line, so a comment after the opening quote is no row,
// but `//` in a row are cells.
static bool map_row(TSLexer *lexer) {
    bool own_line = false;
    while (is_blank(lexer->lookahead) || is_break(lexer->lookahead)) {
        own_line = own_line || is_break(lexer->lookahead);
        lexer->advance(lexer, true);
    }
    if (!own_line || lexer->lookahead == '"' || lexer->eof(lexer)) return false;
    lexer->result_symbol = MAP_ROW;
    while (!at_end_of_line(lexer) && lexer->lookahead != '"') {
        bool cell = !is_blank(lexer->lookahead);
        lexer->advance(lexer, false);
        if (cell) lexer->mark_end(lexer);
    }
    return true;
}

void *tree_sitter_hyped_external_scanner_create(void) { return NULL; }

void tree_sitter_hyped_external_scanner_destroy(void *payload) { (void)payload; }

unsigned tree_sitter_hyped_external_scanner_serialize(void *payload, char *buffer) {
    (void)payload;
    (void)buffer;
    return 0;
}

void tree_sitter_hyped_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
    (void)payload;
    (void)buffer;
    (void)length;
}

bool tree_sitter_hyped_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
    (void)payload;
    if (valid[RECOVERING]) return newline(lexer);
    if (valid[MAP_ROW]) return map_row(lexer);
    // After `map level`: the statement can end here, or continue with a tile set and a map on the same line.
    while (valid[NEWLINE] && is_blank(lexer->lookahead)) lexer->advance(lexer, true);
    if (valid[NEWLINE] && (!valid[MAP_START] || is_break(lexer->lookahead))) return newline(lexer);
    return valid[MAP_START] && map_start(lexer);
}
