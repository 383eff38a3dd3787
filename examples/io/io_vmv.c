/* VessMorphoVis .vmv: a list of vertices "id x y z radius ...", and strands, each a list of ids. */
#include "io_graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct identity {
    size_t id;
    uint32_t node;
} identity;

typedef struct vmv {
    io_reader *r;
    io_cursor c;
    size_t line;
    identity *ids;
    size_t count, capacity;
} vmv;

/* The next line with something on it, without blanks around it. */
static bool next_line(io_cursor *c, size_t *number, io_text *line) {
    while (io_take_line(c, line)) {
        ++*number;
        *line = io_text_trim(*line);
        if (line->size)
            return true;
    }
    return false;
}

io_match io_sniff_vmv(const io_cursor *bytes) {
    io_cursor c = *bytes;
    io_text line;
    size_t number = 0;
    return next_line(&c, &number, &line) &&
                   (io_text_is(line, "$PARAM_BEGIN") || io_text_is(line, "$VERT_LIST_BEGIN"))
               ? IO_YES
               : IO_NO;
}

/* Goes behind the line of that word; sections stand in any order. */
static bool enter(vmv *v, const char *word) {
    io_text line;
    v->c.at = v->line = 0;
    while (next_line(&v->c, &v->line, &line))
        if (io_text_is(line, word))
            return true;
    return io_fail(v->r, "lacks its section %s", word);
}

static bool take_vertex(vmv *v, io_text line) {
    io_cursor words = {(const uint8_t *)line.at, line.size, 0};
    io_text word;
    double values[4];
    size_t id;
    if (!io_take_word(&words, &word) || !io_parse_size(word, &id))
        return io_fail(v->r, "has a vertex without an id in line %zu", v->line);
    for (int i = 0; i < 4; i++)
        if (!io_take_word(&words, &word) || !io_parse_real(word, &values[i]))
            return io_fail(v->r, "needs id, x, y, z and radius in line %zu", v->line);
    if (!io_is_position(values))
        return io_fail(v->r, "has a coordinate that is not finite in line %zu; mend or drop it",
                       v->line);
    identity *ids = io_grow(v->r, v->ids, &v->capacity, v->count + 1, sizeof *ids);
    if (!ids)
        return false;
    v->ids = ids;
    ids[v->count].id = id;
    ids[v->count].node = (uint32_t)v->count;
    return io_graph_add_node(v->r, values, values[3], v->count++);
}

static int by_id(const void *a, const void *b) {
    const identity *x = a, *y = b;
    if (x->id != y->id)
        return x->id < y->id ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

static bool take_vertices(vmv *v) {
    io_text line;
    size_t repeated = 0;
    if (!enter(v, "$VERT_LIST_BEGIN"))
        return false;
    while (next_line(&v->c, &v->line, &line) && !io_text_is(line, "$VERT_LIST_END"))
        if (!take_vertex(v, line) ||
            (v->line % 65536 == 0 && !io_tick(v->r, v->c.at, 2 * v->c.size)))
            return false;
    if (!io_text_is(line, "$VERT_LIST_END"))
        return io_fail(v->r, "ends too early, within its vertices; copy the file again");
    if (!v->count)
        return io_fail(v->r, "holds no tree: it has no vertices");
    qsort(v->ids, v->count, sizeof *v->ids, by_id);
    for (size_t i = 1; i < v->count; i++)
        repeated += v->ids[i].id == v->ids[i - 1].id;
    return !repeated ||
           io_warn(v->r,
                   "%zu vertices have the id of an earlier one; strands use the first of them",
                   repeated);
}

static uint32_t find(const vmv *v, size_t id) {
    size_t low = 0, high = v->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (v->ids[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < v->count && v->ids[low].id == id ? v->ids[low].node : UINT32_MAX;
}

/* "number id id id ..." */
static bool take_strand(vmv *v, io_text line, size_t strand) {
    io_cursor words = {(const uint8_t *)line.at, line.size, 0};
    io_text word;
    uint32_t before = UINT32_MAX;
    if (!io_take_word(&words, &word))
        return true;
    while (io_take_word(&words, &word)) {
        size_t id;
        uint32_t node = io_parse_size(word, &id) ? find(v, id) : UINT32_MAX;
        if (node == UINT32_MAX)
            return io_fail(v->r, "names the vertex '%.*s' in line %zu, which is not in its list",
                           (int)(word.size < 20 ? word.size : 20), word.at, v->line);
        if (before != UINT32_MAX && !io_graph_add_segment(v->r, before, node, (double)NAN, strand))
            return false;
        before = node;
    }
    return true;
}

static bool take_strands(vmv *v) {
    io_text line;
    if (!enter(v, "$STRANDS_LIST_BEGIN"))
        return false;
    for (size_t i = 0; next_line(&v->c, &v->line, &line); i++) {
        if (io_text_is(line, "$STRANDS_LIST_END"))
            return true;
        if (!take_strand(v, line, i) || (i % 4096 == 0 && !io_tick(v->r, v->c.at, v->c.size)))
            return false;
    }
    return io_fail(v->r, "ends too early, within its strands; copy the file again");
}

/* NUM_VERTS and NUM_STRANDS are not needed, only told when they are wrong. */
static bool check_counts(vmv *v) {
    io_text line, word;
    v->c.at = v->line = 0;
    while (next_line(&v->c, &v->line, &line) && !io_text_is(line, "$PARAM_END")) {
        io_cursor words = {(const uint8_t *)line.at, line.size, 0};
        size_t count;
        if (io_take_word(&words, &word) && io_text_is(word, "NUM_VERTS") &&
            io_take_word(&words, &word) && io_parse_size(word, &count) && count != v->count)
            return io_warn(v->r, "NUM_VERTS is %zu, and the file has %zu", count, v->count);
    }
    return true;
}

bool io_read_vmv(io_reader *r, io_cursor *bytes) {
    vmv v;
    memset(&v, 0, sizeof v);
    v.r = r;
    v.c = *bytes;
    io_graph *g = io_graph_new(r, IO_TREE_STRANDS);
    if (!g || !take_vertices(&v) || !take_strands(&v) || !check_counts(&v))
        return false;
    g->unit = "um"; /* the format's */
    return true;
}
