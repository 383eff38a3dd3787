/* SWC: one node a line, "id type x y z radius parent"; # begins a comment. Where the last comment
 * before the first node has a word for each of its columns, and they are more than seven, the
 * further words are names of attributes; the same name several times is one of several components.
 */
#include "io_graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 7, MORE = 32 };

typedef struct row {
    double value[COLUMNS];
    size_t line;
} row;

typedef struct swc {
    io_reader *r;
    row *rows;
    size_t count, capacity;
    size_t columns;      /* 7, or 6 in files without types or without radii; 0 = not known yet */
    bool extra;          /* there are more, without names */
    size_t line;         /* 1-based, of the text */
    io_text comment;     /* the last one before the first row */
    io_text names[MORE]; /* of the columns behind the seventh */
    size_t more;         /* how many have one */
    double *values;      /* of those, more a row; NaN where there is no number */
    size_t value_capacity;
} swc;

/* ---- Rows ------------------------------------------------------------------------------------ */

/* The data of a line: without its comment and the mark of UTF-8. */
static io_text data_of(io_text line, size_t number) {
    const char *comment = memchr(line.at, '#', line.size);
    if (comment)
        line.size = (size_t)(comment - line.at);
    if (number == 1 && line.size >= 3 && !memcmp(line.at, "\xEF\xBB\xBF", 3)) {
        line.at += 3;
        line.size -= 3;
    }
    return io_text_trim(line);
}

/* Numbers of a line, at most COLUMNS; `words` goes behind them. SIZE_MAX: a word is none. */
static size_t numbers_of(io_cursor *words, double value[COLUMNS]) {
    io_text word;
    size_t count = 0;
    while (count < COLUMNS && io_take_word(words, &word))
        if (!io_parse_real(word, &value[count++]))
            return SIZE_MAX;
    return count;
}

static io_cursor words_of(io_text data) {
    return (io_cursor){(const uint8_t *)data.at, data.size, 0};
}

static bool is_whole(double value) {
    return fabs(value) < 9007199254740992.0 && floor(value) == value;
}

io_match io_sniff_swc(const io_cursor *bytes) {
    io_cursor c = *bytes;
    io_text line;
    for (size_t number = 1; io_take_line(&c, &line); number++) {
        io_text data = data_of(line, number);
        io_cursor words = words_of(data);
        double v[COLUMNS];
        if (!data.size)
            continue;
        size_t count = numbers_of(&words, v);
        if ((count != 7 && count != 6) || !is_whole(v[0]) || !is_whole(v[count - 1]))
            return IO_NO;
        return count == 7 && is_whole(v[1]) ? IO_YES : IO_MAYBE;
    }
    return IO_NO;
}

/* "# unit: mm", "# Coordinates in microns; units um": the word after "unit" or "units". */
static void find_unit(swc *s, io_text line) {
    const char *begin = memchr(line.at, '#', line.size);
    if (!begin)
        return;
    io_text text = {begin + 1, line.size - (size_t)(begin + 1 - line.at)}, word;
    bool announced = false;
    for (size_t at = 0; at < text.size && !s->r->graph->unit;) {
        while (at < text.size && strchr(" \t:=,;()[]\"'", text.at[at]))
            at++;
        word.at = text.at + at;
        while (at < text.size && !strchr(" \t:=,;()[]\"'", text.at[at]))
            at++;
        word.size = (size_t)(text.at + at - word.at);
        if (announced)
            s->r->graph->unit = io_unit_named(word);
        announced = announced || io_text_is(word, "unit") || io_text_is(word, "units");
    }
}

/* Before the first row: names of its columns behind the seventh, if the last comment has as many
 * words. */
static void find_names(swc *s, io_text data) {
    io_cursor cells = words_of(data), names = words_of(s->comment);
    io_text word;
    size_t columns = 0, count = 0;
    while (io_take_word(&cells, &word))
        columns++;
    if (columns <= COLUMNS || columns > COLUMNS + MORE)
        return;
    for (; io_take_word(&names, &word); count++)
        if (count >= COLUMNS && count < columns)
            s->names[count - COLUMNS] = word;
    s->more = count == columns ? columns - COLUMNS : 0;
}

/* The numbers of the columns behind the seventh. */
static bool add_values(swc *s, io_cursor *words) {
    io_text word;
    size_t begin = (s->count - 1) * s->more;
    double *values =
        s->more ? io_grow(s->r, s->values, &s->value_capacity, begin + s->more, sizeof *values)
                : NULL;
    if (s->more && !values)
        return false;
    s->values = values;
    for (size_t i = 0; i < s->more; i++)
        if (!io_take_word(words, &word) || !io_parse_real(word, &values[begin + i]))
            values[begin + i] = (double)NAN;
    s->extra = s->extra || io_take_word(words, &word);
    return true;
}

static bool add_row(swc *s, io_text data) {
    row *rows = io_grow(s->r, s->rows, &s->capacity, s->count + 1, sizeof *rows);
    if (!rows)
        return false;
    s->rows = rows;
    if (!s->count)
        find_names(s, data);
    row *to = &rows[s->count++];
    io_cursor words = words_of(data);
    size_t count = numbers_of(&words, to->value);
    to->line = s->line;
    if (count == SIZE_MAX)
        return io_fail(s->r, "has a word that is no number in line %zu: '%.*s'", s->line,
                       (int)(data.size < 60 ? data.size : 60), data.at);
    if (!s->columns && (count == 7 || count == 6))
        s->columns = count;
    if (!s->columns || count != s->columns)
        return io_fail(s->r,
                       "has %zu columns in line %zu; id, type, x, y, z, radius and parent are "
                       "needed",
                       count, s->line);
    return add_values(s, &words);
}

static bool take_rows(swc *s, io_cursor *c) {
    io_text line;
    while (io_take_line(c, &line)) {
        s->line++;
        io_text data = data_of(line, s->line);
        if (!s->r->graph->unit)
            find_unit(s, line);
        if (!s->count && line.size && line.at[0] == '#')
            s->comment = (io_text){line.at + 1, line.size - 1};
        if (data.size && !add_row(s, data))
            return false;
        if (s->line % 65536 == 0 && !io_tick(s->r, c->at, 2 * c->size))
            return false;
    }
    return s->count || io_fail(s->r, "holds no tree: it has no line of numbers");
}

/* Files of six columns lack the type or the radius: the second column tells, for only types are
 * whole everywhere. */
static bool widen_rows(swc *s) {
    bool types = true;
    if (s->columns == COLUMNS)
        return true;
    for (size_t i = 0; i < s->count; i++)
        types = types && is_whole(s->rows[i].value[1]);
    for (size_t i = 0; i < s->count; i++) {
        double *v = s->rows[i].value;
        v[6] = v[5];
        if (types) {
            v[5] = (double)NAN;
        } else {
            memmove(v + 2, v + 1, 4 * sizeof *v);
            v[1] = 0;
        }
    }
    return io_warn(s->r, "the file has six columns; %s",
                   types ? "id, type, x, y, z, parent are read, radii are missing"
                         : "id, x, y, z, radius, parent are read");
}

static bool check_rows(swc *s) {
    for (size_t i = 0; i < s->count; i++) {
        const double *v = s->rows[i].value;
        size_t line = s->rows[i].line;
        if (!is_whole(v[0]) || !is_whole(v[6]))
            return io_fail(s->r, "has an id or a parent that is no whole number in line %zu", line);
        if (!io_is_position(v + 2))
            return io_fail(s->r, "has a coordinate that is not finite in line %zu; mend or drop it",
                           line);
    }
    return true;
}

/* ---- Parents --------------------------------------------------------------------------------- */

typedef struct identity {
    double id;
    uint32_t node;
} identity;

static int by_id(const void *a, const void *b) {
    const identity *x = a, *y = b;
    if (x->id != y->id)
        return x->id < y->id ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

/* Of several nodes with this id the first; UINT32_MAX: none. */
static uint32_t find(const identity *ids, size_t count, double id) {
    size_t low = 0, high = count;
    if (count && id - ids[0].id >= 0 && id - ids[0].id < (double)count) {
        size_t guess = (size_t)(id - ids[0].id); /* ids without gaps and repetitions */
        if (ids[guess].id == id && (!guess || ids[guess - 1].id != id))
            return ids[guess].node;
    }
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (ids[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && ids[low].id == id ? ids[low].node : UINT32_MAX;
}

static identity *sort_ids(swc *s) {
    identity *ids = io_alloc(s->r, s->count, sizeof *ids);
    size_t repeated = 0;
    bool sorted = true;
    for (size_t i = 0; ids && i < s->count; i++) {
        ids[i].id = s->rows[i].value[0];
        ids[i].node = (uint32_t)i;
        sorted = sorted && (!i || ids[i - 1].id <= ids[i].id);
    }
    if (ids && !sorted)
        qsort(ids, s->count, sizeof *ids, by_id);
    for (size_t i = 1; ids && i < s->count; i++)
        repeated += ids[i].id == ids[i - 1].id;
    if (repeated && !io_warn(s->r,
                             "%zu nodes have the id of an earlier node; a parent of that id is the "
                             "first of them",
                             repeated))
        return NULL;
    return ids;
}

/* parents[i] = node, UINT32_MAX at a root. */
static bool find_parents(swc *s, const identity *ids, uint32_t *parents) {
    size_t missing = 0, own = 0, line = 0;
    for (size_t i = 0; i < s->count; i++) {
        double parent = s->rows[i].value[6];
        parents[i] = parent < 0 ? UINT32_MAX : find(ids, s->count, parent);
        if (parents[i] == i) {
            parents[i] = UINT32_MAX;
            own++;
        } else if (parents[i] == UINT32_MAX && parent > 0) {
            line = missing++ ? line : s->rows[i].line;
        }
    }
    return (!missing ||
            io_warn(s->r,
                    "%zu nodes name a parent that is missing and became roots, first in "
                    "line %zu",
                    missing, line)) &&
           (!own || io_warn(s->r, "%zu nodes name themselves as parent and became roots", own));
}

/* Follows every node to where its way was seen before; a way that meets itself is a cycle. */
static bool check_cycles(swc *s, const uint32_t *parents) {
    uint32_t *seen = io_alloc(s->r, s->count, sizeof *seen); /* by the way from node seen - 1 */
    if (!seen)
        return false;
    for (size_t i = 0; i < s->count; i++) {
        size_t at = i;
        for (; at != UINT32_MAX && !seen[at]; at = parents[at])
            seen[at] = (uint32_t)i + 1;
        if (at != UINT32_MAX && seen[at] == (uint32_t)i + 1)
            return io_fail(s->r,
                           "has a cycle: node %.0f in line %zu is its own ancestor; mend the "
                           "parents (last column)",
                           s->rows[at].value[0], s->rows[at].line);
    }
    return true;
}

/* Columns that follow each other under one name are one attribute. */
static bool add_attributes(swc *s) {
    io_columns *columns = &s->r->graph->node_columns;
    for (size_t i = 0, n; i < s->more; i += n) {
        for (n = 1; i + n < s->more && s->names[i].size == s->names[i + n].size &&
                    !memcmp(s->names[i].at, s->names[i + n].at, s->names[i].size);)
            n++;
        double *values = io_alloc(s->r, s->count, n * sizeof *values);
        if (!values)
            return false;
        for (size_t k = 0; k < s->count * n; k++)
            values[k] = s->values[k / n * s->more + i + k % n];
        io_view view = io_view_doubles(values, s->count, (uint32_t)n);
        if (!io_attach_rows(s->r, columns, s->names[i], &view, NULL, 0, s->count, 0, "node"))
            return false;
    }
    return true;
}

static bool build(swc *s) {
    io_reader *r = s->r;
    if (s->count >= UINT32_MAX)
        return io_fail(r, "has more than 4294967294 nodes, which is the most that is supported");
    identity *ids = sort_ids(s);
    uint32_t *parents = io_alloc(r, s->count, sizeof *parents);
    double *types = io_alloc(r, s->count, sizeof *types);
    if (!ids || !parents || !types || !find_parents(s, ids, parents) || !check_cycles(s, parents))
        return false;
    for (size_t i = 0; i < s->count; i++) {
        types[i] = s->rows[i].value[1];
        if (!io_graph_add_node(r, s->rows[i].value + 2, s->rows[i].value[5], i))
            return false;
    }
    for (size_t i = 0; i < s->count; i++)
        if (parents[i] != UINT32_MAX &&
            !io_graph_add_segment(r, parents[i], i, (double)NAN, r->graph->segment_count))
            return false;
    io_view view = io_view_doubles(types, s->count, 1);
    return io_attach_rows(r, &r->graph->node_columns, io_text_of("type"), &view, NULL, 0, s->count,
                          0, "node") &&
           add_attributes(s);
}

bool io_read_swc(io_reader *r, io_cursor *bytes) {
    swc s;
    memset(&s, 0, sizeof s);
    s.r = r;
    if (!io_graph_new(r, IO_TREE_IDS) || !take_rows(&s, bytes) || !widen_rows(&s) ||
        !check_rows(&s) || !build(&s))
        return false;
    return !s.extra ||
           io_warn(r, "columns behind the seventh are left out, where the last comment before the "
                      "nodes does not name them all");
}
