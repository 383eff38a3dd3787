/* GXL trees of VascuSynth and OpenCCO: nodes with a position, edges with a radius and more. Ids and
 * names of attributes may begin with a blank. */
#include "io_graph.h"

#include <expat.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct identity {
    const char *id;
    uint32_t item;
} identity;

typedef struct edge {
    const char *from, *to;
} edge;

typedef struct value { /* a number of an edge */
    uint32_t item, name;
    double number;
} value;

typedef struct gxl {
    io_reader *r;
    XML_Parser parser;
    bool failed, in_node, in_edge, in_number;
    size_t depth;
    char *attribute; /* name of the open attr, NULL = none */
    double position[3];
    size_t coordinates;
    size_t flat; /* nodes of two coordinates */
    char text[64];
    size_t text_size;
    identity *nodes;
    size_t node_count, node_capacity;
    edge *edges;
    size_t edge_count, edge_capacity;
    value *values;
    size_t value_count, value_capacity;
    char **names;
    size_t name_count, name_capacity;
} gxl;

enum { MOST_NAMES = 64 };

io_match io_sniff_gxl(const io_cursor *bytes) {
    io_cursor c = {bytes->bytes, bytes->size < 4096 ? bytes->size : 4096, 0};
    io_text word;
    bool xml = false;
    while (io_take_word(&c, &word)) {
        xml = xml || memchr(word.at, '<', word.size < 4 ? word.size : 4);
        if (!xml)
            return IO_NO;
        for (; word.size >= 4; word.at++, word.size--)
            if (io_text_starts(word, "<gxl"))
                return IO_YES;
    }
    return IO_NO;
}

/* ---- Tags ------------------------------------------------------------------------------------ */

static void stop(gxl *g, bool good) {
    if (good)
        return;
    g->failed = true;
    XML_StopParser(g->parser, XML_FALSE);
}

static char *copy_attribute(gxl *g, const XML_Char **attributes, const char *name) {
    for (size_t i = 0; attributes[i]; i += 2)
        if (io_text_is(io_text_trim(io_text_of(attributes[i])), name))
            return io_copy_text(g->r, io_text_trim(io_text_of(attributes[i + 1])));
    io_error_set(g->r->error, "is damaged in line %lu: a tag lacks its '%s'",
                 (unsigned long)XML_GetCurrentLineNumber(g->parser), name);
    return NULL;
}

static bool begin_node(gxl *g, const XML_Char **attributes) {
    identity *nodes = io_grow(g->r, g->nodes, &g->node_capacity, g->node_count + 1, sizeof *nodes);
    char *id = copy_attribute(g, attributes, "id");
    if (nodes)
        g->nodes = nodes;
    if (!nodes || !id)
        return false;
    nodes[g->node_count].id = id;
    nodes[g->node_count].item = (uint32_t)g->node_count;
    g->node_count++;
    g->in_node = true;
    g->coordinates = 0;
    memset(g->position, 0, sizeof g->position);
    return true;
}

static bool end_node(gxl *g) {
    g->in_node = false;
    if (g->coordinates < 2)
        return io_fail(g->r, "lacks the position of its node '%.40s' before line %lu",
                       g->nodes[g->node_count - 1].id,
                       (unsigned long)XML_GetCurrentLineNumber(g->parser));
    g->flat += g->coordinates == 2;
    if (!io_is_position(g->position))
        return io_fail(g->r, "has a coordinate that is not finite at its node '%.40s'",
                       g->nodes[g->node_count - 1].id);
    return io_graph_add_node(g->r, g->position, (double)NAN, g->node_count - 1);
}

static bool begin_edge(gxl *g, const XML_Char **attributes) {
    edge *edges = io_grow(g->r, g->edges, &g->edge_capacity, g->edge_count + 1, sizeof *edges);
    if (!edges)
        return false;
    g->edges = edges;
    edge *e = &edges[g->edge_count];
    e->from = copy_attribute(g, attributes, "from");
    e->to = e->from ? copy_attribute(g, attributes, "to") : NULL;
    g->edge_count++;
    g->in_edge = true;
    return e->to != NULL;
}

static bool is_number_tag(const char *name) {
    return !strcmp(name, "float") || !strcmp(name, "double") || !strcmp(name, "int");
}

static void XMLCALL on_begin(void *user, const XML_Char *name, const XML_Char **attributes) {
    gxl *g = user;
    bool good = true;
    g->depth++;
    g->in_number = false; /* numbers hold no tags */
    if (g->depth == 1 && strcmp(name, "gxl") != 0)
        good = io_fail(g->r, "is not a GXL file: its root is <%.40s>", name);
    else if (!strcmp(name, "node") && !g->in_node && !g->in_edge)
        good = begin_node(g, attributes);
    else if (!strcmp(name, "edge") && !g->in_node && !g->in_edge)
        good = begin_edge(g, attributes);
    else if (!strcmp(name, "attr") && (g->in_node || g->in_edge))
        good = (g->attribute = copy_attribute(g, attributes, "name")) != NULL;
    else if (g->attribute && is_number_tag(name))
        g->in_number = true;
    g->text_size = 0;
    stop(g, good);
}

static void XMLCALL on_text(void *user, const XML_Char *text, int size) {
    gxl *g = user;
    size_t left = sizeof g->text - g->text_size, wanted = (size_t)size;
    if (!g->in_number)
        return;
    wanted = wanted < left ? wanted : left; /* no number is that long; a cut one fails */
    memcpy(g->text + g->text_size, text, wanted);
    g->text_size += wanted;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static uint32_t find_name(gxl *g, const char *name) {
    for (size_t i = 0; i < g->name_count; i++)
        if (!strcmp(g->names[i], name))
            return (uint32_t)i;
    if (g->name_count == MOST_NAMES)
        return io_warn(g->r, "the edges have more than %d attributes; the others are left out",
                       MOST_NAMES)
                   ? MOST_NAMES
                   : UINT32_MAX;
    char **names = io_grow(g->r, g->names, &g->name_capacity, g->name_count + 1, sizeof *names);
    if (!names)
        return UINT32_MAX;
    g->names = names;
    names[g->name_count] = g->attribute;
    return (uint32_t)g->name_count++;
}

static bool keep_value(gxl *g, double number) {
    uint32_t name = find_name(g, g->attribute);
    if (name >= MOST_NAMES)
        return name != UINT32_MAX;
    value *values =
        io_grow(g->r, g->values, &g->value_capacity, g->value_count + 1, sizeof *values);
    if (!values)
        return false;
    g->values = values;
    value next = {(uint32_t)(g->edge_count - 1), name, number};
    values[g->value_count++] = next;
    return true;
}

static bool end_number(gxl *g) {
    io_text text = {g->text, g->text_size};
    double number;
    g->in_number = false;
    if (!io_parse_real(io_text_trim(text), &number))
        return io_fail(g->r, "is damaged in line %lu: '%.*s' is no number",
                       (unsigned long)XML_GetCurrentLineNumber(g->parser), (int)text.size, text.at);
    if (g->in_edge)
        return keep_value(g, number);
    if (!strcmp(g->attribute, "position") && g->coordinates < 3)
        g->position[g->coordinates++] = number;
    return true;
}

static void XMLCALL on_end(void *user, const XML_Char *name) {
    gxl *g = user;
    bool good = true;
    g->depth--;
    if (g->in_number && is_number_tag(name))
        good = end_number(g);
    else if (!strcmp(name, "attr"))
        g->attribute = NULL;
    else if (g->in_node && !strcmp(name, "node"))
        good = end_node(g);
    else if (!strcmp(name, "edge"))
        g->in_edge = false;
    stop(g, good);
}

static bool parse(gxl *g, const io_cursor *c) {
    enum { PART = 1 << 20 };
    for (size_t at = 0; at < c->size; at += PART) {
        size_t size = c->size - at < PART ? c->size - at : PART;
        enum XML_Status status =
            XML_Parse(g->parser, (const char *)c->bytes + at, (int)size, at + size == c->size);
        if (g->failed)
            return false;
        if (status != XML_STATUS_OK)
            return io_fail(g->r, "is damaged XML in line %lu (%s); copy the file again",
                           (unsigned long)XML_GetCurrentLineNumber(g->parser),
                           XML_ErrorString(XML_GetErrorCode(g->parser)));
        if (!io_tick(g->r, at, 2 * c->size))
            return false;
    }
    return true;
}

/* ---- Edges ----------------------------------------------------------------------------------- */

static int by_id(const void *a, const void *b) {
    const identity *x = a, *y = b;
    int order = strcmp(x->id, y->id);
    return order ? order : x->item < y->item ? -1 : x->item > y->item;
}

/* The first node of that id; UINT32_MAX: none. */
static uint32_t find_node(const gxl *g, const char *id) {
    size_t low = 0, high = g->node_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(g->nodes[middle].id, id) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < g->node_count && !strcmp(g->nodes[low].id, id) ? g->nodes[low].item : UINT32_MAX;
}

static bool sort_nodes(gxl *g) {
    size_t repeated = 0;
    qsort(g->nodes, g->node_count, sizeof *g->nodes, by_id);
    for (size_t i = 1; i < g->node_count; i++)
        repeated += !strcmp(g->nodes[i].id, g->nodes[i - 1].id);
    return !repeated ||
           io_warn(g->r,
                   "%zu nodes have the id of an earlier node; edges lead to the first of them",
                   repeated);
}

/* Edge numbers of one name, as an array; NaN where an edge has none. */
static double *column_of(gxl *g, size_t name) {
    double *column = io_alloc(g->r, g->edge_count, sizeof *column);
    for (size_t i = 0; column && i < g->edge_count; i++)
        column[i] = (double)NAN;
    for (size_t i = 0; column && i < g->value_count; i++)
        if (g->values[i].name == name)
            column[g->values[i].item] = g->values[i].number;
    return column;
}

static const double *radius_column(gxl *g) {
    for (size_t i = 0; i < g->name_count; i++)
        if (io_text_is(io_text_of(g->names[i]), "radius"))
            return column_of(g, i);
    io_warn(g->r, "the edges have no radius");
    return column_of(g, MOST_NAMES);
}

static bool add_edges(gxl *g) {
    const double *radii = radius_column(g);
    size_t lost = 0;
    if (!radii)
        return false;
    for (size_t i = 0; i < g->edge_count; i++) {
        uint32_t from = find_node(g, g->edges[i].from), to = find_node(g, g->edges[i].to);
        if (from == UINT32_MAX || to == UINT32_MAX)
            lost++;
        else if (!io_graph_add_segment(g->r, from, to, radii[i], i))
            return false;
    }
    if (lost && !io_warn(g->r, "%zu edges lead to a node that is missing and were left out", lost))
        return false;
    return io_graph_spread_radii(g->r);
}

static bool add_columns(gxl *g) {
    io_graph *graph = g->r->graph;
    for (size_t i = 0; i < g->name_count; i++) {
        double *column = column_of(g, i);
        io_view view = io_view_doubles(column, g->edge_count, 1);
        if (!column ||
            !io_attach_rows(g->r, &graph->segment_columns, io_text_of(g->names[i]), &view,
                            graph->segment_rows, 0, graph->segment_count, 0, "edge"))
            return false;
    }
    return !g->flat || io_warn(g->r, "%zu nodes have two coordinates; z is 0 there", g->flat);
}

bool io_read_gxl(io_reader *r, io_cursor *bytes) {
    gxl g;
    memset(&g, 0, sizeof g);
    g.r = r;
    g.parser = XML_ParserCreate(NULL);
    if (!g.parser)
        return io_fail(r, "cannot be read: the XML parser got no memory");
    XML_SetUserData(g.parser, &g);
    XML_SetElementHandler(g.parser, on_begin, on_end);
    XML_SetCharacterDataHandler(g.parser, on_text);
    bool parsed = io_graph_new(r, IO_TREE_IDS) && parse(&g, bytes);
    XML_ParserFree(g.parser);
    if (!parsed)
        return false;
    if (!g.node_count)
        return io_fail(r, "holds no tree: it has no nodes");
    return sort_nodes(&g) && add_edges(&g) && add_columns(&g);
}
