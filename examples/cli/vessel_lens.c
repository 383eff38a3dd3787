#include "vessel_lens.h"

#include "report.h"

#include <string.h>

/* Cuts have the colours of the vessels that they cut. */
static void cut(cli_vessel_options *o, lao_int operation) {
    if (!o->shape_color && !o->shape_count)
        o->shape_color = "nearest";
    o->shapes[o->shape_count++] = (cli_shape_option){(uint32_t)operation, o->lens.text};
}

void cli_lens_plan(cli_options *options, cli_lens *lens) {
    const cli_lens_option *o = &options->vessel.lens;
    if (!o->text)
        return;
    lens->options = *options;
    lens->source = options->file_count ? options->files[0] : options->all;
    lens->options.files = &lens->source;
    lens->options.file_count = options->file_count || o->tree;
    if (o->tree) {
        lens->source.path = o->tree;
        lens->options.vessel.surface = NULL;
    }
    if (o->color)
        lens->source.color = o->color;
    lens->options.all = lens->source;
    lens->options.vessel.style = o->style;
    if (!o->is_circle) {
        cut(&options->vessel, SDV_SUBTRACTION);
        cut(&lens->options.vessel, SDV_INTERSECTION);
    }
}

bool cli_lens_load(cli_lens *lens, const cli_tree *outside) {
    const cli_lens_option *o = &lens->options.vessel.lens;
    io_contents none;
    char text[256];
    cli_place place = {&none, outside->vessel.origin};
    memset(&none, 0, sizeof none);
    if (!o->text)
        return true;
    if (!cli_tree_load(&lens->options, &place, 0, &lens->tree))
        return false;
    for (int k = 0; k < 3; k++) { /* that of a surface is its own */
        double apart = lens->tree.vessel.origin[k] - outside->vessel.origin[k];
        if (apart < 0 || apart > 0)
            return cli_fail("%s: --lens-tree is a surface; write a tree", lens->tree.name);
    }
    for (uint32_t i = 0; o->tree && cli_tree_warning(&lens->tree, i, text, sizeof text); i++)
        cli_warn(lens->tree.name, text);
    return true;
}

bool cli_lens_prepare(cli_lens *lens, cli_tree *outside) {
    cli_scene *scene = &lens->tree.scene;
    if (!lens->options.vessel.lens.text)
        return true;
    if (!cli_tree_prepare(&lens->tree))
        return false;
    cli_set *set = cli_scene_add(&outside->scene);
    if (!set)
        return false;
    *set = scene->sets[0];
    memset(&scene->sets[0], 0, sizeof scene->sets[0]); /* moved */
    return true;
}

static void aim(sdv_settings *settings, float side, const double circle[3], const cli_shot *shot) {
    double width = shot->width, height = shot->height, margin = shot->margin;
    settings->lens_side = side;
    settings->lens_x = (float)((circle[0] * width + margin) / (width + 2 * margin));
    settings->lens_y = (float)((circle[1] * height + margin) / (height + 2 * margin));
    settings->lens_radius = (float)(circle[2] * height / (height + 2 * margin));
    settings->set |= SDV_SET(lens_side) | SDV_SET(lens_x) | SDV_SET(lens_y) | SDV_SET(lens_radius);
}

void cli_lens_aim(cli_lens *lens, cli_tree *outside, const cli_shot *shot) {
    const cli_lens_option *o = &lens->options.vessel.lens;
    if (!o->text || !o->is_circle)
        return;
    aim(&lens->tree.settings, SDV_LENS_INSIDE, o->circle, shot);
    aim(&outside->settings, SDV_LENS_OUTSIDE, o->circle, shot);
}

void cli_lens_fit(cli_lens *lens, cli_tree *outside, const cli_shot *shot) {
    const cli_lens_option *o = &lens->options.vessel.lens;
    if (!o->text)
        return;
    cli_tree_fit_period(&lens->tree, shot);
    if (!o->is_circle)
        lens->tree.settings.void_style = SDV_VOID_PLAIN; /* it would be all of the picture's */
    cli_lens_aim(lens, outside, shot);
}
