// What the lexer cannot tell by itself: which line breaks end a statement, and the rows of an inline map.
//
// A line break ends a statement unless the next line goes on with it: with `and`, `or`, `->` or `{`, none of which can
// begin a statement. Inside of parentheses, after an operator or a comma the parser does not ask for an end.
// The scanner keeps no state.

#include "tree_sitter/parser.h"

enum Token { NEWLINE, MAP_START, MAP_ROW, RECOVERING };

static bool is_blank(int32_t c) { return c == ' ' || c == '\t'; }

static bool is_break(int32_t c) { return c == '\n' || c == '\r'; }

static bool at_end_of_line(TSLexer *lexer) { return is_break(lexer->lookahead) || lexer->eof(lexer); }

// Whether a letter, digit or `_` can go on after a word. Letters beyond ASCII make a longer word, too.
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

// Whether what follows, over blank lines and comments, goes on with the statement.
static bool goes_on(TSLexer *lexer) {
    for (;;) {
        while (is_blank(lexer->lookahead) || is_break(lexer->lookahead)) lexer->advance(lexer, false);
        if (lexer->lookahead != '/') break;
        lexer->advance(lexer, false);
        if (lexer->lookahead != '/') return false;
        to_end_of_line(lexer);
    }
    switch (lexer->lookahead) {
        case '{': return true;
        case '-': lexer->advance(lexer, false); return lexer->lookahead == '>';
        case 'a': return is_word(lexer, "and");
        case 'o': return is_word(lexer, "or");
        default: return false;
    }
}

static bool newline(TSLexer *lexer) {
    while (is_blank(lexer->lookahead)) lexer->advance(lexer, true);
    // A comment before the break is a node: the lexer takes it, then asks again.
    if (!is_break(lexer->lookahead)) return false;
    bool returned = lexer->lookahead == '\r';
    lexer->advance(lexer, false);
    if (returned && lexer->lookahead == '\n') lexer->advance(lexer, false);
    lexer->mark_end(lexer);
    lexer->result_symbol = NEWLINE;
    return !goes_on(lexer);
}

// The quote that opens a map: nothing but a comment stands after it.
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

// A row from its first cell to its last one. It stands on a line of its own, so a comment after the opening quote is
// none, but `//` in a row are cells.
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
    // After `map level`, which may end here, or name the tile set of the map that follows on the same line.
    while (valid[NEWLINE] && is_blank(lexer->lookahead)) lexer->advance(lexer, true);
    if (valid[NEWLINE] && (!valid[MAP_START] || is_break(lexer->lookahead))) return newline(lexer);
    return valid[MAP_START] && map_start(lexer);
}
