/* `lineao vessel` keeps its contract: trees, layouts, distances, cuts and cameras come out as files
 * whose numbers agree with each other and with the shapes that were asked for, on both backends
 * alike; the layout stands beside the tree or alone, and what is at risk is marked in both; a lens
 * shows another look inside; nothing is drawn unless a picture, a dump or timings are asked for;
 * wrong usage is one line.
 */
#include "program.h"

#include "image.h"
#include "sdfvessel.h"

#include <cJSON.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char *program; /* its path, from the command line */

#define RUN(...) program_start(program, false, __VA_ARGS__)
#define SMALL "--size 96x72 --ssaa 1 --grid 48 "

static void expect_ok(program_run run) {
    if (run.code != 0)
        print_error("%s", run.err);
    assert_int_equal(run.code, 0);
    program_free(&run);
}

static double number(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static bool exists(const char *path) {
    struct stat s;
    return stat(path, &s) == 0;
}

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* A Y of three limbs, 1100 mm away from the origin, where floats are coarse. */
static void write_y(void) {
    write_file("y.swc", "1 0 0 0 -1100 2 -1\n2 0 0 10 -1100 2 1\n3 0 -8 18 -1100 1 2\n"
                        "4 0 8 18 -1100 1.5 2\n5 0 16 24 -1096 1 4\n");
    write_file("cam.json", "{\"eye\":[4,12,-1040],\"center\":[4,12,-1100],\"up\":[0,1,0],"
                           "\"fovy\":32}");
}
static const double y_nodes[5][4] = {{0, 0, -1100, 2},
                                     {0, 10, -1100, 2},
                                     {-8, 18, -1100, 1},
                                     {8, 18, -1100, 1.5},
                                     {16, 24, -1096, 1}};
static const int y_segments[4][2] = {{0, 1}, {1, 2}, {1, 3}, {3, 4}};
#define Y "y.swc --unit mm --camera cam.json " SMALL
#define BARE "--set parameterization=off " /* a dump's is on, and costs */

/* Signed distance to one limb in double precision, by the least over its balls. */
static double limb_distance(int limb, const double p[3]) {
    const double *a = y_nodes[y_segments[limb][0]], *b = y_nodes[y_segments[limb][1]];
    double least = INFINITY;
    for (int i = 0; i <= 20000; i++) {
        double t = i / 20000.0, sum = 0;
        for (int k = 0; k < 3; k++)
            sum += (p[k] - a[k] - t * (b[k] - a[k])) * (p[k] - a[k] - t * (b[k] - a[k]));
        least = fmin(least, sqrt(sum) - a[3] - t * (b[3] - a[3]));
    }
    return least;
}

static double y_distance(const double p[3]) {
    double least = INFINITY;
    for (int i = 0; i < 4; i++)
        least = fmin(least, limb_distance(i, p));
    return least;
}

/* ---- dumps ------------------------------------------------------------------------------ */

typedef struct dump {
    image_exr image;
    const float *p[3], *n[3], *segment, *mask, *dmin, *distance;
    size_t count;
} dump;

static void read_dump(const char *path, dump *out) {
    const image_part *part;
    memset(out, 0, sizeof *out);
    assert_true(image_read_exr(path, &out->image, NULL));
    out->p[0] = image_exr_channel(&out->image, "position.X", &part);
    out->p[1] = image_exr_channel(&out->image, "position.Y", NULL);
    out->p[2] = image_exr_channel(&out->image, "position.Z", NULL);
    out->n[0] = image_exr_channel(&out->image, "normal.X", NULL);
    out->n[1] = image_exr_channel(&out->image, "normal.Y", NULL);
    out->n[2] = image_exr_channel(&out->image, "normal.Z", NULL);
    out->segment = image_exr_channel(&out->image, "segment.V", NULL);
    out->mask = image_exr_channel(&out->image, "mask.V", NULL);
    out->dmin = image_exr_channel(&out->image, "dmin.V", NULL);
    out->distance = image_exr_channel(&out->image, "distance.V", NULL);
    assert_true(out->p[0] && out->p[2] && out->n[0] && out->segment && out->mask && out->dmin);
    assert_non_null(image_exr_channel(&out->image, "out.R", NULL));
    out->count = (size_t)part->width * part->height;
}

static void test_dump(void **state) {
    dump gl, vk;
    uint32_t hits = 0, misses = 0;
    (void)state;
    expect_ok(RUN("vessel " Y BARE "--dump gl.exr --target 0,5,-1090,3"));
    expect_ok(RUN("vessel " Y BARE "--dump vk.exr --target 0,5,-1090,3 --backend vk"));
    read_dump("gl.exr", &gl);
    read_dump("vk.exr", &vk);
    assert_non_null(gl.distance);
    for (size_t i = 0; i < gl.count; i++) {
        const double p[3] = {(double)gl.p[0][i], (double)gl.p[1][i], (double)gl.p[2][i]};
        double normal = 0;
        assert_true((gl.segment[i] >= 0) == (gl.mask[i] == 1));
        assert_memory_equal(&gl.segment[i], &vk.segment[i], 4);
        assert_memory_equal(&gl.dmin[i], &vk.dmin[i], 4);
        for (int k = 0; k < 3; k++) {
            assert_memory_equal(&gl.p[k][i], &vk.p[k][i], 4);
            assert_memory_equal(&gl.n[k][i], &vk.n[k][i], 4);
            normal += (double)gl.n[k][i] * gl.n[k][i];
        }
        if (gl.segment[i] < 0) {
            misses++;
            continue;
        }
        hits++;
        if (hits % 7 == 0) { /* the oracle is slow */
            double apart =
                sqrt(p[0] * p[0] + (p[1] - 5) * (p[1] - 5) + (p[2] + 1090) * (p[2] + 1090)) - 3;
            assert_true(fabs(y_distance(p)) < 2e-3);
            assert_true(fabs(limb_distance((int)gl.segment[i], p)) < 2e-3);
            assert_true(fabs(normal - 1) < 1e-5);
            assert_true(fabs((double)gl.distance[i] - apart) < 1e-3);
        }
    }
    assert_in_range(hits, 200, 5000);
    assert_in_range(misses, 200, 7000);
    image_exr_free(&gl.image);
    image_exr_free(&vk.image);
}

static void test_cuts(void **state) {
    dump d;
    uint32_t cut = 0, left = 0;
    (void)state;
    expect_ok(RUN("vessel " Y BARE "--dump cut.exr --subtract plane:0,0,-1,1100"));
    read_dump("cut.exr", &d); /* the half in front, z > -1100, goes */
    for (size_t i = 0; i < d.count; i++) {
        if (d.segment[i] == -1)
            continue;
        assert_true(d.p[2][i] < -1100 + 1e-3f || d.segment[i] >= 0);
        left++;
        if (d.segment[i] == -2) {
            cut++;
            assert_true(fabsf(d.p[2][i] + 1100) < 1e-3f);
            assert_true(fabsf(d.n[2][i] - 1) < 1e-5f);
        }
    }
    assert_in_range(cut, 200, left);
    image_exr_free(&d.image);
    expect_ok(RUN("vessel " Y BARE "--dump cut.exr --intersect sphere:0,10,-1100,5 --union "
                  "box:-9,-2,-1101,-5,2,-1099"));
    read_dump("cut.exr", &d);
    for (size_t i = 0; i < d.count; i++) {
        double x = (double)d.p[0][i], y = (double)d.p[1][i] - 10, z = (double)d.p[2][i] + 1100;
        bool boxed = x > -9.01 && x < -4.99 && y > -12.01 && y < -7.99;
        if (d.segment[i] != -1)
            assert_true(boxed || x * x + y * y + z * z < 25.01);
    }
    image_exr_free(&d.image);
}

/* The trunk (radius 2, along y, z its shorter axis) is an ellipse of the ratio; noise moves it by
 * no more than is said; a number for all nodes and an attribute of the file that says the same give
 * the same bits, on both backends. */
static void test_forms(void **state) {
    dump plain, number, named;
    uint32_t trunk = 0, moved = 0;
    (void)state;
    write_file("form.swc", "# id type x y z radius parent flow spread\n"
                           "1 0 0 0 -1100 2 -1 7 0.25\n2 0 0 10 -1100 2 1 7 0.25\n"
                           "3 0 -8 18 -1100 1 2 7 0.25\n4 0 8 18 -1100 1.5 2 7 0.25\n"
                           "5 0 16 24 -1096 1 4 7 0.25\n");
    expect_ok(RUN("vessel " Y BARE "--section 0.5 --dump plain.exr"));
    expect_ok(RUN("vessel " Y BARE "--section 0.5 --uncertainty 0.25 --bump-size 0.8 --dump "
                  "number.exr"));
    expect_ok(RUN("vessel form.swc --unit mm --camera cam.json " SMALL BARE
                  "--section 0.5 --uncertainty spread --bump-size 0.8 --dump named.exr "
                  "--backend vk"));
    read_dump("plain.exr", &plain);
    read_dump("number.exr", &number);
    read_dump("named.exr", &named);
    assert_memory_equal(number.segment, named.segment, 4 * number.count);
    for (int k = 0; k < 3; k++) {
        assert_memory_equal(number.p[k], named.p[k], 4 * number.count);
        assert_memory_equal(number.n[k], named.n[k], 4 * number.count);
    }
    for (size_t i = 0; i < plain.count; i++) {
        float off[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            const dump *d = k ? &number : &plain;
            float x = d->p[0][i], y = d->p[1][i], z = 2 * (d->p[2][i] + 1100);
            off[k] = sqrtf(x * x + z * z) - 2;
            if (d->segment[i] != 0 || !(y > 0.5f && y < 7))
                off[k] = NAN;
        }
        trunk += fabsf(off[0]) < 2e-3f;
        assert_false(fabsf(off[0]) > 2e-3f);
        assert_false(fabsf(off[1]) > 0.252f);
        moved += fabsf(off[1]) > 0.1f;
    }
    assert_in_range(trunk, 100, 2000);
    assert_in_range(moved, trunk / 5, trunk);
    image_exr_free(&plain.image);
    image_exr_free(&number.image);
    image_exr_free(&named.image);
    expect_fault(RUN("vessel y.swc --section 2 -o a.png"), 2, "0.1..1");
    expect_fault(RUN("vessel y.swc --unit mm --uncertainty wide -o a.png"), 1, "'wide'");
}

/* A closed mesh cuts like the box that it is; a second tree like itself. */
static void test_cut_by_files(void **state) {
    dump box, mesh;
    uint32_t same = 0, covered = 0;
    (void)state;
    write_file("box.obj", "v -20 5 -1110\nv 20 5 -1110\nv 20 30 -1110\nv -20 30 -1110\n"
                          "v -20 5 -1090\nv 20 5 -1090\nv 20 30 -1090\nv -20 30 -1090\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    expect_ok(RUN("vessel " Y BARE "--dump box.exr --subtract box:-20,5,-1110,20,30,-1090"));
    expect_ok(RUN("vessel " Y BARE "--dump mesh.exr --subtract box.obj"));
    read_dump("box.exr", &box);
    read_dump("mesh.exr", &mesh);
    for (size_t i = 0; i < box.count; i++) {
        covered += box.segment[i] != -1;
        same += box.segment[i] == mesh.segment[i];
    }
    assert_in_range(covered, 50, 3000);
    assert_in_range(same, box.count - box.count / 200, box.count); /* sampled: the rim may differ */
    image_exr_free(&box.image);
    image_exr_free(&mesh.image);
    expect_ok(RUN("vessel " Y BARE "--dump tree.exr --subtract y.swc"));
}

/* ---- numbers ---------------------------------------------------------------------------- */

static void test_layout_and_tree(void **state) {
    (void)state;
    expect_ok(RUN("vessel y.swc --unit mm --layout l.json --layout l.svg --tree t.json "
                  "--target 8,18,-1090,2"));
    cJSON *tree = read_json("t.json"), *layout = read_json("l.json");
    const cJSON *nodes = cJSON_GetObjectItem(tree, "nodes"), *item;
    assert_int_equal(cJSON_GetArraySize(nodes), 5);
    for (int i = 0; i < 5; i++) {
        const cJSON *node = cJSON_GetArrayItem(nodes, i), *p = cJSON_GetObjectItem(node, "p");
        for (int k = 0; k < 3; k++)
            assert_true(fabs(cJSON_GetArrayItem(p, k)->valuedouble - y_nodes[i][k]) < 1e-5);
        assert_true(fabs(number(node, "r") - y_nodes[i][3]) < 1e-6);
    }
    const cJSON *segments = cJSON_GetObjectItem(tree, "segments");
    assert_int_equal(cJSON_GetArraySize(segments), 4);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 2; k++)
            assert_int_equal(cJSON_GetArrayItem(cJSON_GetArrayItem(segments, i), k)->valueint,
                             y_segments[i][k]);
    }
    int found = 0;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(layout, "nodes")) {
        /* Node 4 and its edge from 1: limbs 2 and 3. The ball's centre is 10 mm from limb 2. */
        assert_in_range((int)(1e6 * number(item, "h")), 0, 1000000);
        const cJSON *distance = cJSON_GetObjectItem(item, "distance");
        if (number(item, "id") == 4) {
            const double centre[3] = {8, 18, -1090};
            double truth = fmin(limb_distance(2, centre), limb_distance(3, centre)) - 2;
            assert_true(fabs(distance->valuedouble - truth) < 1e-3);
            found++;
        }
        if (number(item, "parent") == -1)
            assert_true(cJSON_IsNull(distance));
    }
    assert_int_equal(found, 1);
    cJSON_Delete(tree);
    cJSON_Delete(layout);
    FILE *svg = fopen("l.svg", "rb");
    char head[64] = "";
    assert_non_null(svg);
    assert_true(fread(head, 1, sizeof head - 1, svg) > 0);
    fclose(svg);
    assert_non_null(strstr(head, "<svg"));
}

/* The numbers of a path: a straight needle beside the trunk. */
static void test_path(void **state) {
    (void)state;
    expect_ok(RUN("vessel y.swc --unit mm --layout l.json --path -5,-10,-1100:-5,12,-1100"));
    cJSON *layout = read_json("l.json");
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(layout, "nodes")) {
        if (number(item, "id") == 1) /* the trunk: radius 2, axis at x = 0 */
            assert_true(fabs(number(item, "distance") - 3) < 1e-4);
    }
    cJSON_Delete(layout);
}

/* The branches at risk of the only target are numbered, the nearest first. */
static void check_numbers(const char *report, int least) {
    cJSON *json = cJSON_Parse(report);
    assert_non_null(json);
    const cJSON *item, *target = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "targets"), 0),
                       *branches = cJSON_GetObjectItem(target, "branches");
    double last = number(target, "least_distance");
    int next = 1;
    cJSON_ArrayForEach(item, branches) {
        assert_true(number(item, "number") == next++);
        assert_true(number(item, "distance") >= last - 1e-6);
        assert_true(number(item, "distance") < number(target, "risk"));
        last = number(item, "distance");
    }
    assert_true(next > least);
    cJSON_Delete(json);
}

/* Without a picture no GPU is opened: a device that does not exist goes unnoticed. */
static void test_no_gpu(void **state) {
    (void)state;
    setenv("VK_ICD_FILENAMES", "/nowhere.json", 1);
    setenv("VK_DRIVER_FILES", "/nowhere.json", 1); /* the newer name, which wins */
    expect_ok(RUN("vessel --nodes 200 --layout l.json --backend vk"));
    program_run listed = RUN("vessel --nodes 200 --link --target 32,8,12,16 --json --backend vk");
    assert_int_equal(listed.code, 0);
    check_numbers(listed.out, 5);
    program_free(&listed);
    program_run run = RUN("vessel --nodes 200 " SMALL "-o never.png --backend vk");
    assert_int_equal(run.code, 1);
    assert_false(exists("never.png"));
    program_free(&run);
}

static void test_cameras(void **state) {
    dump one, all;
    (void)state;
    write_file("cams.json", "[{\"eye\":[4,12,-1040],\"center\":[4,12,-1100],\"up\":[0,1,0],"
                            "\"fovy\":32},{\"eye\":[60,12,-1100],\"center\":[0,12,-1100],"
                            "\"up\":[0,1,0],\"ortho_height\":40}]");
    expect_ok(RUN("vessel y.swc --unit mm " SMALL BARE "--cameras cams.json -o f_%%04d.png --dump "
                  "f_%%04d.exr --timings t.json --save-camera used.json"));
    assert_true(exists("f_0000.png") && exists("f_0001.png") && exists("f_0001.exr"));
    assert_false(exists("f_0002.png"));
    expect_ok(RUN("vessel " Y BARE "--dump one.exr"));
    read_dump("one.exr", &one);
    read_dump("f_0000.exr", &all);
    assert_memory_equal(one.segment, all.segment, 4 * one.count);
    image_exr_free(&one.image);
    image_exr_free(&all.image);
    expect_ok(RUN("vessel --nodes 100 " SMALL "--frames 2 -o turn.png"));
    assert_true(exists("turn_0000.png") && exists("turn_0001.png"));
}

static void test_looks(void **state) {
    static const char *const looks[] = {
        "--style plain",
        "--style ink",
        "--style glow",
        "--color radius",
        "--color order",
        "--color #804020",
        "--set near_miss=exact",
        "--set outline_unit=mm --silhouette 1",
        "--set layout_ph=0 --set width=2",
        "--set field_shadow=on",
        "--subtract sphere:8,18,-1100,4 --shape-color nearest",
        ("--union ellipsoid:0,10,-1100,9,14,9 --subtract "
         "sphere:0,10,-1090,9 --union tree --shape-color #804020"),
        "--layout-weight near --target 0,0,-1100,1 --layout n.json"};
    (void)state;
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++)
        expect_ok(RUN("vessel " Y "-o look.png %s", looks[i]));
    expect_ok(RUN("vessel " Y "-o look.png --color distance --target 0,0,-1100,1 --range 0,9"));
    program_run run = RUN("vessel " Y "-o look.png --json");
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out);
    assert_non_null(json);
    assert_true(number(json, "segments") == 4);
    cJSON_Delete(json);
    program_free(&run);
}

/* ---- the layout beside the tree --------------------------------------------------------- */

typedef struct pixels {
    uint32_t width, height;
    uint8_t *rgb; /* owned */
} pixels;

static void read_pixels(const char *path, pixels *out) {
    char error[IMAGE_ERROR_SIZE];
    if (!image_read_png(path, 3, &out->width, &out->height, &out->rgb, error))
        fail_msg("%s", error);
}

/* No frame of a turn touches its rim; a single picture is framed as ever. */
static void test_turn(void **state) {
    (void)state;
    expect_ok(RUN("vessel y.swc --unit mm " SMALL "--style plain --frames 8 -o t%%d.png"));
    for (int frame = 0; frame < 8; frame++) {
        char path[32]; /* an int fits, whatever a compiler makes of the loop */
        pixels p;
        snprintf(path, sizeof path, "t%d.png", frame);
        read_pixels(path, &p);
        size_t inked = 0;
        for (uint32_t y = 0; y < p.height; y++) {
            for (uint32_t x = 0; x < p.width; x++) {
                bool rim = x == 0 || y == 0 || x == p.width - 1 || y == p.height - 1;
                bool paper = memcmp(p.rgb + 3 * ((size_t)y * p.width + x), p.rgb, 3) == 0;
                assert_true(paper || !rim);
                inked += !paper;
            }
        }
        assert_true(inked > (size_t)p.width * p.height / 40);
        free(p.rgb);
    }
    const char *names[] = {"", "--frames 1 ", "--frames 2 "};
    char *texts[3];
    for (int i = 0; i < 3; i++) {
        expect_ok(RUN("vessel y.swc --unit mm " SMALL "%s--save-camera turn.json", names[i]));
        texts[i] = read_text("turn.json");
    }
    assert_string_equal(texts[0], texts[1]);
    assert_string_not_equal(texts[0], texts[2]);
    for (int i = 0; i < 3; i++)
        free(texts[i]);
}

/* The layout drawn by the backend, beside the picture and without one: the same for both backends,
 * whatever the camera; where the trunk is, its colour. */
static void test_layout_picture(void **state) {
    pixels gl, vk, alone;
    size_t ink = 0;
    (void)state;
    expect_ok(RUN("vessel " Y "-o seen.png --layout gl.png --layout l.svg --color #c02020"));
    expect_ok(RUN("vessel " Y "--layout vk.png --backend vk --color #c02020"));
    expect_ok(
        RUN("vessel y.swc --unit mm " SMALL "--layout alone.png --view axial --color #c02020"));
    assert_true(exists("seen.png") && exists("l.svg"));
    read_pixels("gl.png", &gl);
    read_pixels("vk.png", &vk);
    read_pixels("alone.png", &alone);
    assert_int_equal(gl.width, 96);
    assert_int_equal(gl.height, 72);
    assert_memory_equal(gl.rgb, vk.rgb, 96 * 72 * 3);
    assert_memory_equal(gl.rgb, alone.rgb, 96 * 72 * 3);
    for (size_t i = 0; i < 96 * 72; i++)
        ink += gl.rgb[3 * i] == 0xc0 && gl.rgb[3 * i + 1] == 0x20 && gl.rgb[3 * i + 2] == 0x20;
    assert_in_range(ink, 40, 96 * 72 / 3);
    free(gl.rgb);
    free(vk.rgb);
    free(alone.rgb);
    expect_fault(RUN("vessel " Y "--layout l.bmp"), 2, ".png");
}

/* Built by the device, the field has the CPU's bits: every number of a dump and every pixel, of a
 * tree cut or not, by both backends. */
static void test_device_field(void **state) {
    static const char *const more[2] = {"", "--union tree --subtract sphere:4,14,-1098,4 "};
    (void)state;
    for (int cut = 0; cut < 2; cut++) {
        dump cpu, device;
        pixels a, b;
        expect_ok(RUN("vessel " Y BARE "%s--dump cpu.exr -o cpu.png", more[cut]));
        read_dump("cpu.exr", &cpu);
        read_pixels("cpu.png", &a);
        for (int vk = 0; vk < 2; vk++) {
            expect_ok(RUN("vessel " Y BARE
                          "%s--dump dev.exr -o dev.png --field device --backend %s",
                          more[cut], vk ? "vk" : "gl"));
            read_dump("dev.exr", &device);
            read_pixels("dev.png", &b);
            assert_int_equal(cpu.count, device.count);
            assert_memory_equal(cpu.segment, device.segment, 4 * cpu.count);
            assert_memory_equal(cpu.dmin, device.dmin, 4 * cpu.count);
            for (int k = 0; k < 3; k++) {
                assert_memory_equal(cpu.p[k], device.p[k], 4 * cpu.count);
                assert_memory_equal(cpu.n[k], device.n[k], 4 * cpu.count);
            }
            assert_memory_equal(a.rgb, b.rgb, 3 * (size_t)a.width * a.height);
            image_exr_free(&device.image);
            free(b.rgb);
        }
        image_exr_free(&cpu.image);
        free(a.rgb);
    }
    program_run run = RUN("vessel " Y "--field device --layout d.png --json");
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out);
    const cJSON *by = cJSON_GetObjectItem(cJSON_GetObjectItem(json, "grid"), "by");
    assert_string_equal(cJSON_GetStringValue(by), "device");
    cJSON_Delete(json);
    program_free(&run);
    expect_fault(RUN("vessel " Y "--field gpu -o x.png"), 2, "cpu");
}

/* How many pixels of a rectangle differ. */
static uint32_t differing(const pixels *a, const pixels *b, uint32_t x, uint32_t y, uint32_t w,
                          uint32_t h) {
    uint32_t count = 0;
    for (uint32_t j = y; j < y + h; j++) {
        for (uint32_t i = x; i < x + w; i++) {
            size_t at = 3 * ((size_t)j * a->width + i);
            count += memcmp(a->rgb + at, b->rgb + at, 3) != 0;
        }
    }
    return count;
}

/* The segments and branches of a target of the report against brute force. */
static void check_target(const cJSON *target, const double ball[4], double risk) {
    const cJSON *item;
    double near[4], least = INFINITY;
    int at_risk = 0, i = 0;
    for (int k = 0; k < 4; k++) {
        near[k] = limb_distance(k, ball) - ball[3];
        at_risk += near[k] < risk;
        least = fmin(least, near[k]);
    }
    assert_true(fabs(number(target, "least_distance") - least) < 1e-3);
    assert_true(number(target, "risk") == risk);
    const cJSON *segments = cJSON_GetObjectItem(target, "segments");
    assert_int_equal(cJSON_GetArraySize(segments), at_risk);
    cJSON_ArrayForEach(item, segments) {
        int k = (int)number(item, "segment");
        assert_in_range(k, i, 3);
        assert_true(fabs(number(item, "distance") - near[k]) < 1e-3);
        i = k + 1;
    }
    /* Branches end in nodes 1, 2 and 4; that of 4 is limbs 2 and 3. */
    const double branches[5] = {0, near[0], near[1], 0, fmin(near[2], near[3])};
    int count = (near[0] < risk) + (near[1] < risk) + (branches[4] < risk);
    const cJSON *list = cJSON_GetObjectItem(target, "branches");
    assert_int_equal(cJSON_GetArraySize(list), count);
    cJSON_ArrayForEach(item, list) {
        int rank = 1; /* its number: 1 is the nearest */
        for (int k = 0; k < 5; k++)
            rank += (k == 1 || k == 2 || k == 4) && branches[k] < number(item, "distance") - 1e-3;
        assert_true(fabs(number(item, "distance") - branches[(int)number(item, "id")]) < 1e-3);
        assert_true(number(item, "number") == rank);
    }
}

#define LINK "vessel y.swc --unit mm --grid 48 --ssaa 1 --link --size 320x180 "
#define TARGETS "--target 8,18,-1090,2 --target -8,18,-1095,1 "
static const double risk_balls[2][4] = {{8, 18, -1090, 2}, {-8, 18, -1095, 1}};

/* Both backends give the same page (with marks: test_risk); a column shows its own target in both
 * views. */
static void test_link(void **state) {
    pixels gl, vk;
    uint32_t others = 0;
    (void)state;
    program_run run = RUN(LINK "--risk 7 " TARGETS "--json"); /* the numbers need no picture */
    assert_int_equal(run.code, 0);
    cJSON *json = cJSON_Parse(run.out);
    assert_non_null(json);
    const cJSON *targets = cJSON_GetObjectItem(json, "targets");
    assert_int_equal(cJSON_GetArraySize(targets), 2);
    for (int i = 0; i < 2; i++)
        check_target(cJSON_GetArrayItem(targets, i), risk_balls[i], 7);
    cJSON_Delete(json);
    program_free(&run);
    expect_ok(RUN(LINK "--risk 0 " TARGETS "-o gl.png"));
    expect_ok(RUN(LINK "--risk 0 " TARGETS "-o vk.png --backend vk"));
    read_pixels("gl.png", &gl);
    read_pixels("vk.png", &vk);
    assert_int_equal(gl.width, 320);
    assert_int_equal(gl.height, 180);
    assert_int_equal(differing(&gl, &vk, 0, 0, 320, 180), 0);
    for (uint32_t y = 24; y < 110; y++) { /* the second column is 157 pixels to the right */
        for (uint32_t x = 8; x < 155; x++) {
            const uint8_t *at = gl.rgb + 3 * ((size_t)y * 320 + x);
            others += memcmp(at, at + 3 * 157, 3) != 0;
        }
    }
    assert_in_range(others, 400, 10000);
    free(gl.rgb);
    free(vk.rgb);
}

/* The pattern marks what is at risk, and that alone; without a target the colours are the layout's;
 * nothing of it needs a picture. */
#define RISK "vessel " Y "--target 0,-4,-1100,1 --range 0,40 --colormap gray --size 288x216 "
static void test_risk(void **state) {
    pixels with, without, vk;
    dump d;
    uint32_t inside = 0, outside = 0, marked = 0;
    (void)state;
    expect_ok(RUN(RISK "--risk 8 --set ssp_period=3 -o with.png"));
    expect_ok(RUN("vessel " Y BARE "--target 0,-4,-1100,1 --size 288x216 --dump risk.exr"));
    expect_ok(RUN(RISK "-o without.png"));
    read_pixels("with.png", &with);
    read_pixels("without.png", &without);
    read_dump("risk.exr", &d);
    expect_ok(RUN(RISK "--risk 8 --set ssp_period=3 --backend vk -o without.png"));
    read_pixels("without.png", &vk);
    assert_int_equal(differing(&with, &vk, 0, 0, 288, 216), 0); /* both backends alike */
    free(vk.rgb);
    for (uint32_t i = 0; i < d.count; i++) {
        bool differs = memcmp(with.rgb + 3 * i, without.rgb + 3 * i, 3) != 0;
        inside += d.segment[i] >= 0 && d.distance[i] < 4;
        marked += d.segment[i] >= 0 && d.distance[i] < 4 && differs;
        outside += differs && !(d.segment[i] >= 0 && d.distance[i] < 12);
    }
    assert_int_equal(outside, 0);
    assert_in_range(marked, inside / 5, inside * 4 / 5);
    image_exr_free(&d.image);
    free(with.rgb);
    free(without.rgb);
    expect_ok(RUN(LINK "--risk 7 --path -5,-10,-1100:-5,12,-1100 -o path.png --legend right"));
    expect_ok(RUN("vessel y.swc --unit mm --grid 48 --ssaa 1 --link --size 240x120 -o plain.png "
                  "--set layout_radial=on --frames 2"));
    assert_true(exists("plain_0001.png"));
}

/* A scale beside the colours; colours that show no number have none. */
static void test_legend(void **state) {
    pixels with, without;
    (void)state;
    expect_ok(RUN("vessel " Y "--color radius --legend right --size 288x216 -o with.png"));
    expect_ok(RUN("vessel " Y "--color radius --size 288x216 -o without.png"));
    read_pixels("with.png", &with);
    read_pixels("without.png", &without);
    assert_int_equal(differing(&with, &without, 0, 0, 150, 216), 0);
    assert_in_range(differing(&with, &without, 150, 0, 138, 216), 500, 20000);
    free(with.rgb);
    free(without.rgb);
    /* all commands say once what a small picture has no room for: as a line, or in the report */
    const char *commands[] = {"vessel y.swc --unit mm --grid 48 --color radius --json",
                              "vessel y.swc --unit mm --grid 48 --color radius --frames 2",
                              "vessel y.swc --unit mm --color radius --layout out.png",
                              "surface --scene aneurysm --json",
                              "surface --scene aneurysm --frames 2",
                              "render --scene flow --lines 20 --color speed"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        bool json = strstr(commands[i], "--json") != NULL, layout = strstr(commands[i], "--layout");
        program_run run = RUN("%s --legend right --size 64x48 --ssaa 1 %s", commands[i],
                              layout ? "" : "-o out.png");
        const char *note = strstr(json ? run.out : run.err, "no room for");
        assert_int_equal(run.code, 0);
        assert_non_null(note);
        assert_null(strstr(note + 1, "no room for"));
        assert_true(!json || !*run.err);
        assert_true(json || strncmp(run.err, "lineao: out.png: warning: no room", 33) == 0);
        program_free(&run);
    }
    expect_fault(RUN("vessel " Y "--legend left -o never.png"), 1, "--legend");
    assert_false(exists("never.png"));
}

/* What needs texture coordinates turns them on: ink, and the images of a dump. */
static void test_implied(void **state) {
    static const char *const inks[] = {"hatch", "shadow", "void"};
    image_exr exr;
    pixels plain, ink;
    (void)state;
    expect_ok(RUN("vessel " Y "-o plain.png"));
    expect_ok(RUN("vessel " Y "--set near_miss=none --field-occlusion off --dump on.exr"));
    assert_true(image_read_exr("on.exr", &exr, NULL));
    assert_non_null(image_exr_channel(&exr, "uv.U", NULL));
    assert_non_null(image_exr_channel(&exr, "guide.X", NULL));
    assert_non_null(image_exr_channel(&exr, "bgposition.Z", NULL));
    image_exr_free(&exr);
    expect_ok(RUN("vessel " Y BARE "--set near_miss=none --field-occlusion off --dump off.exr"));
    assert_true(image_read_exr("off.exr", &exr, NULL));
    assert_null(image_exr_channel(&exr, "uv.U", NULL));
    image_exr_free(&exr);
    read_pixels("plain.png", &plain);
    for (size_t i = 0; i < sizeof inks / sizeof *inks; i++) {
        expect_ok(RUN("vessel " Y "-o ink.png --style %s --shadow-width 9", inks[i]));
        read_pixels("ink.png", &ink);
        assert_in_range(differing(&plain, &ink, 0, 0, 96, 72), i == 1 ? 1 : 50, 96 * 72);
        free(ink.rgb);
    }
    free(plain.rgb);
}

static void test_faults(void **state) {
    static const struct {
        const char *line, *word;
        int code;
    } rows[] = {
        {"vessel y.swc", "-o out.png", 2},
        {"vessel y.swc y.swc -o a.png", "second", 2},
        {"vessel y.swc y.swc -o a.png", "lineao render", 2},
        {"vessel --nodes 0 -o a.png", "a whole number from 1", 2},
        {"vessel y.swc -o a.jpg", "must end in .png", 2},
        {"vessel y.swc --target 1,2 -o a.png", "--target: '1,2'", 1},
        {"vessel y.swc --subtract none.stl -o a.png", "none.stl: is no shape, nor a file", 1},
        {"vessel y.swc --size 32768x32768 --ssaa 4 -o a.png", "--size: times --ssaa", 1},
        {"vessel y.swc --grid 4 -o a.png", "16..512", 2},
        {"vessel y.swc --grid x -o a.png", "--grid", 2},
        {"vessel y.swc --layout l.txt", ".svg or .json", 2},
        {"vessel y.swc --nodes 10 -o a.png", "embedded", 2},
        {"vessel y.swc --color distance -o a.png", "--target", 2},
        {"vessel y.swc --risk 5 -o a.png", "--target", 2},
        {"vessel y.swc --path 0,0,0:1,1,1 --path 0,0,0:2,2,2 -o a.png", "--link", 2},
        {"vessel y.swc --shape-color nearest -o a.png", "shape", 2},
        {"vessel y.swc --lens blob:1 -o a.png", "--lens", 2},
        {"vessel y.swc --lens circle:1,2 -o a.png", "circle:X,Y,R", 2},
        {"vessel y.swc --lens circle:0.5,0.5,0 -o a.png", "--lens", 2},
        {"vessel y.swc --lens sphere:1,2,3,-4 -o a.png", "--lens", 2},
        {"vessel y.swc --lens-style ink -o a.png", "write --lens", 2},
        {"vessel y.swc --lens-tree y.swc -o a.png", "write --lens", 2},
        {"vessel y.swc --lens circle:0,0,1 --lens-style wild -o a.png", "--lens-style", 2},
        {"vessel y.swc --lens circle:0,0,1 --lens-color distance -o a.png", "--target", 2},
        {"vessel y.swc --lens circle:0,0,1 --link -o a.png", "--link", 2},
        {"vessel y.swc --lens circle:0,0,1 --dump a.exr", "--dump", 2},
        {"vessel y.swc --lens sphere:0,0,0,1 --lens-style void -o a.png", "circle", 2},
        {"vessel y.swc --unit mm --lens circle:0,0,1 --lens-tree none.swc -o a.png", "none.swc", 1},
        {"vessel y.swc --link --size 60x40 -o a.png", "--size", 1},
        {"vessel y.swc --set silhouete=1 -o a.png", "silhouette", 2},
        {"vessel y.swc --style wild -o a.png", "--style", 2},
        {"vessel none.swc -o a.png", "none.swc", 1},
        {"vessel cam.json -o a.png", "cam.json", 1},
        {"vessel y.swc --subtract sphere:1,2 --unit mm -o a.png", "shape", 1},
        {"vessel y.swc --subtract tree --unit mm -o a.png", "tree", 1},
        {"vessel y.swc --union ellipsoid:0,0,0,1,0,1 --unit mm -o a.png", "shape", 1},
        {"vessel y.swc --layout-weight near --unit mm -o a.png", "--target", 1},
        {"vessel y.swc --subtract nothing.stl --unit mm -o a.png", "nothing.stl", 1},
        {"vessel y.swc --path 1,2 --unit mm --layout l.json", "X,Y,Z", 1},
        {"vessel y.swc --color wss --unit mm -o a.png", "wss", 1},
        {"vessel y.swc --cameras none.json --unit mm -o a.png", "none.json", 1},
        {"vessel y.swc --unit mm -o nowhere/a.png", "nowhere", 1},
    };
    (void)state;
    remove("a.png");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        expect_fault(RUN("%s", rows[i].line), rows[i].code, rows[i].word);
    assert_false(exists("a.png"));
}

/* A picture of Y with these flags is, in each pixel, that with `inside` or with `outside` alone, as
 * its centre is in the circle or not. inside NULL: other.swc. */
static void expect_circle(const char *flags, const char *inside, const char *outside) {
    const double circle[3] = {0.45 * 96, 0.4 * 72, 0.3 * 72};
    pixels all, in, out;
    uint32_t differ = 0;
    expect_ok(RUN("vessel " Y "--set lens_rim=0 --lens circle:0.45,0.4,0.3 %s -o l.png", flags));
    if (inside)
        expect_ok(RUN("vessel " Y "%s -o i.png", inside));
    else
        expect_ok(RUN("vessel other.swc --unit mm --camera cam.json " SMALL
                      "--style plain --color #208040 -o i.png"));
    expect_ok(RUN("vessel " Y "%s -o o.png", outside));
    read_pixels("l.png", &all);
    read_pixels("i.png", &in);
    read_pixels("o.png", &out);
    for (uint32_t i = 0; i < 96 * 72; i++) {
        double x = i % 96 + 0.5 - circle[0], y = i / 96 + 0.5 - circle[1];
        const pixels *of = x * x + y * y <= circle[2] * circle[2] ? &in : &out;
        assert_memory_equal(all.rgb + 3 * (size_t)i, of->rgb + 3 * (size_t)i, 3);
        differ += memcmp(in.rgb + 3 * (size_t)i, out.rgb + 3 * (size_t)i, 3) != 0;
    }
    assert_true(differ > 100);
    free(all.rgb);
    free(in.rgb);
    free(out.rgb);
}

static void test_lens(void **state) {
    (void)state;
    write_file("other.swc", "1 0 -9 9 -1100 3 -1\n2 0 9 14 -1100 2 1\n");
    expect_circle("--lens-style crosshatch --lens-color #ffffff",
                  "--style crosshatch --color #ffffff", "");
    expect_circle("--backend vk --margin 9 --style ink --subtract sphere:8,18,-1100,4",
                  "--margin 9 --subtract sphere:8,18,-1100,4",
                  "--margin 9 --style ink --subtract sphere:8,18,-1100,4");
    /* plain: nothing by the size of the scene, which the other tree makes greater */
    expect_circle("--style plain --color #804020 --lens-style plain --lens-color #208040 "
                  "--lens-tree other.swc",
                  NULL, "--style plain --color #804020");
    expect_ok(RUN("vessel " Y "--lens sphere:0,10,-1100,6 --lens-color radius --legend right "
                  "-o l.png"));
    expect_ok(RUN("vessel --surface bone --lens circle:0.5,0.5,0.3 --lens-style hatch " SMALL
                  "-o l.png"));
}

static void test_help(void **state) {
    (void)state;
    program_run run = RUN("help vessel");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "--subtract"));
    assert_non_null(strstr(run.out, "--link"));
    assert_non_null(strstr(run.out, "--risk"));
    assert_non_null(strstr(run.out, "--legend"));
    assert_non_null(strstr(run.out, "--silhouette"));
    assert_non_null(strstr(run.out, "--layout-ph"));
    program_free(&run);
}

static int enter(void **state) {
    char folder[] = "/tmp/lineao_vessel_XXXXXX";
    (void)state;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    write_y();
    return 0;
}

static int leave(void **state) {
    (void)state;
    return system("rm -f -- *.png *.exr *.json *.svg *.swc *.obj") != 0;
}

/* test_vessel_cli PROGRAM [marks] [FILTER]: numbers, files and colours; or what is linked, marked
 * and inked, and lenses. Halves, so that they run side by side. */
int main(int argc, char **argv) {
    const struct CMUnitTest numbers[] = {
        cmocka_unit_test(test_help),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_dump),
        cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_cut_by_files),
        cmocka_unit_test(test_layout_and_tree),
        cmocka_unit_test(test_path),
        cmocka_unit_test(test_cameras),
        cmocka_unit_test(test_turn),
        cmocka_unit_test(test_layout_picture),
        cmocka_unit_test(test_device_field),
        cmocka_unit_test(test_looks),
        cmocka_unit_test(test_no_gpu), /* the last: it changes the environment */
    };
    const struct CMUnitTest marks[] = {
        cmocka_unit_test(test_link),    cmocka_unit_test(test_risk), cmocka_unit_test(test_legend),
        cmocka_unit_test(test_implied), cmocka_unit_test(test_lens),
    };
    int second = argc > 2 && strcmp(argv[2], "marks") == 0;
    if (argc < 2)
        return 1;
    program = argv[1];
    if (argc > 2 + second)
        cmocka_set_test_filter(argv[2 + second]);
    return second ? cmocka_run_group_tests(marks, enter, leave)
                  : cmocka_run_group_tests(numbers, enter, leave);
}
