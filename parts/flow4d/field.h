/* ================================================================================================
 * field: velocity, its mask and what is derived from it, at a place and time; the temporal maximum.
   Uses host. */

static lao_result flow4d__domain_check(const flow4d_host *host, const flow4d_field *field,
                                       double from_world[12]) {
    size_t frames = field->velocity_at ? 1 : field->frame_count;
    lao_result result = flow4d__lattice_check(host, field->size, frames, 3 * sizeof(float),
                                              field->to_world, from_world);
    if (result == LAO_OK && !(field->period >= 0.0 && flow4d__number(field->period) &&
                              (field->period > 0.0 || frames < 2))) {
        char text[64];
        snprintf(text, sizeof text, "%g ms for %lu frames", field->period, (unsigned long)frames);
        return flow4d__fail(host, FLOW4D_LOG_PERIOD, text);
    }
    return result;
}

lao_result flow4d_sampler_make(const flow4d_host *host, const flow4d_field *field,
                               flow4d_sampler *sampler) {
    flow4d_sampler made;
    lao_result result;
    if (!field || !sampler) {
        return flow4d__fail(host, FLOW4D_LOG_NULL_ARGUMENT, "the field or the sampler");
    }
    if (!field->velocity && !field->velocity_at) {
        return flow4d__fail(host, FLOW4D_LOG_VELOCITY, "velocity and velocity_at are NULL");
    }
    made.field = *field;
    result = flow4d__domain_check(host, field, made.from_world);
    if (result == LAO_OK) {
        *sampler = made;
    }
    return result;
}

lao_result flow4d_field_check(const flow4d_host *host, const flow4d_field *field) {
    flow4d_sampler sampler;
    return flow4d_sampler_make(host, field, &sampler);
}

void flow4d_to_world(const flow4d_sampler *sampler, const double index[3], double position[3]) {
    flow4d__apply(sampler->field.to_world, index, position);
}

void flow4d_from_world(const flow4d_sampler *sampler, const double position[3], double index[3]) {
    flow4d__apply(sampler->from_world, position, index);
}

/* The eight voxels around a place, clamped, and their weights. */
typedef struct flow4d__cell {
    size_t voxel[8];
    double weight[8];
} flow4d__cell;

static void flow4d__cell_make(const uint32_t size[3], const double index[3], flow4d__cell *cell) {
    size_t low[3], step[3], stride = 1;
    double part[3];
    int a, c;
    for (a = 0; a < 3; a++) {
        double last = (double)(size[a] - 1), g = index[a] > 0.0 ? index[a] : 0.0;
        double whole;
        g = g < last ? g : last;
        whole = floor(g);
        part[a] = g - whole;
        low[a] = (size_t)whole * stride;
        step[a] = whole < last ? stride : 0;
        stride *= size[a];
    }
    for (c = 0; c < 8; c++) {
        int x = c & 1, y = (c >> 1) & 1, z = c >> 2;
        cell->voxel[c] =
            low[0] + low[1] + low[2] + (x ? step[0] : 0) + (y ? step[1] : 0) + (z ? step[2] : 0);
        cell->weight[c] = (x ? part[0] : 1.0 - part[0]) * (y ? part[1] : 1.0 - part[1]) *
                          (z ? part[2] : 1.0 - part[2]);
    }
}

/* Adds one frame. Voxels without weight do not count, so that what is unknown beside a voxel centre
   does not spoil it. */
static void flow4d__add_frame(const flow4d__cell *cell, const float *velocity, double scale,
                              double sum[3]) {
    int c;
    for (c = 0; c < 8; c++) {
        double w = cell->weight[c] * scale;
        const float *v = velocity + 3 * cell->voxel[c];
        if (w > 0.0) {
            sum[0] += w * (double)v[0];
            sum[1] += w * (double)v[1];
            sum[2] += w * (double)v[2];
        }
    }
}

/* Velocity of the array at a place given as voxel index, all finite. */
static void flow4d__sample_array(const flow4d_field *field, const double index[3], double time,
                                 double velocity[3]) {
    size_t frame_floats = 3 * (size_t)field->size[0] * field->size[1] * field->size[2];
    flow4d__cell cell;
    uint32_t f = 0;
    double part = 0.0;
    if (field->frame_count > 1) {
        double cycles = time / field->period;
        double frames = (cycles - floor(cycles)) * (double)field->frame_count;
        /* a time a hair before 0 rounds to the end of the cycle, which is its beginning */
        f = frames < (double)field->frame_count ? (uint32_t)frames : 0;
        part = frames < (double)field->frame_count ? frames - (double)f : 0.0;
    }
    flow4d__cell_make(field->size, index, &cell);
    velocity[0] = velocity[1] = velocity[2] = 0.0;
    flow4d__add_frame(&cell, field->velocity + f * frame_floats, 1.0 - part, velocity);
    if (part > 0.0) {
        f = f + 1 < field->frame_count ? f + 1 : 0;
        flow4d__add_frame(&cell, field->velocity + f * frame_floats, part, velocity);
    }
}

static void flow4d__sample(const flow4d_sampler *sampler, const double position[3],
                           const double index[3], double time, double velocity[3]) {
    if (sampler->field.velocity_at) {
        sampler->field.velocity_at(sampler->field.user, position, time, velocity);
    } else {
        flow4d__sample_array(&sampler->field, index, time, velocity);
    }
}

void flow4d_sample(const flow4d_sampler *sampler, const double position[3], double time,
                   double velocity[3]) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    if (!flow4d__finite(index, 3) || !flow4d__number(time)) {
        velocity[0] = velocity[1] = velocity[2] =
            time - time + (index[0] - index[0]) + (index[1] - index[1]) + (index[2] - index[2]);
        return;
    }
    flow4d__sample(sampler, position, index, time, velocity);
}

static int flow4d__in_mask(const flow4d_field *field, const double index[3],
                           flow4d_mask_mode mode) {
    double sum = 0.0;
    flow4d__cell cell;
    int a, c;
    if (mode == FLOW4D_MASK_TRILINEAR) {
        flow4d__cell_make(field->size, index, &cell);
        for (c = 0; c < 8; c++) {
            sum += field->mask[cell.voxel[c]] ? cell.weight[c] : 0.0;
        }
        return sum >= 0.5;
    }
    {
        size_t voxel = 0, stride = 1;
        for (a = 0; a < 3; a++) { /* the upper face of the box belongs to the last voxel */
            size_t g = (size_t)(index[a] + 0.5);
            voxel += (g < field->size[a] ? g : (size_t)field->size[a] - 1) * stride;
            stride *= field->size[a];
        }
        return field->mask[voxel] != 0;
    }
}

/* NaN is outside. */
static int flow4d__inside(const flow4d_sampler *sampler, const double position[3],
                          const double index[3], flow4d_mask_mode mode) {
    const flow4d_field *field = &sampler->field;
    int a;
    for (a = 0; a < 3; a++) {
        if (!(index[a] >= -0.5 && index[a] <= (double)field->size[a] - 0.5)) {
            return 0;
        }
    }
    if (field->mask && mode != FLOW4D_MASK_NONE && !flow4d__in_mask(field, index, mode)) {
        return 0;
    }
    return !field->inside_at || field->inside_at(field->user, position);
}

int flow4d_inside(const flow4d_sampler *sampler, const double position[3], flow4d_mask_mode mode) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    return flow4d__inside(sampler, position, index, mode);
}

/* Velocity at a place that is inside; 0, or -1 when it is not or the velocity is not finite. */
static int flow4d__probe(const flow4d_sampler *sampler, flow4d_mask_mode mode,
                         const double position[3], double time, double velocity[3]) {
    double index[3];
    flow4d__apply(sampler->from_world, position, index);
    if (!flow4d__inside(sampler, position, index, mode)) {
        return -1;
    }
    flow4d__sample(sampler, position, index, time, velocity);
    return flow4d__finite(velocity, 3) ? 0 : -1;
}

/* Change of the velocity from one voxel index along an axis to the next, by central differences. */
static void flow4d__difference(const flow4d_sampler *sampler, const double index[3], int axis,
                               double time, double slope[3]) {
    const flow4d_field *field = &sampler->field;
    double last = (double)(field->size[axis] - 1), from[3], to[3], p[3], a[3], b[3];
    int i;
    memcpy(from, index, sizeof from);
    memcpy(to, index, sizeof to);
    if (field->velocity_at) {
        from[axis] -= 0.01;
        to[axis] += 0.01;
    } else {
        from[axis] = from[axis] - 1.0 > 0.0 ? from[axis] - 1.0 : 0.0;
        to[axis] = to[axis] + 1.0 < last ? to[axis] + 1.0 : last;
        from[axis] = from[axis] < last ? from[axis] : last;
        to[axis] = to[axis] > 0.0 ? to[axis] : 0.0;
    }
    slope[0] = slope[1] = slope[2] = 0.0;
    if (!(to[axis] > from[axis])) {
        return; /* a single voxel, or beyond the border: constant */
    }
    flow4d__apply(field->to_world, from, p);
    flow4d__sample(sampler, p, from, time, a);
    flow4d__apply(field->to_world, to, p);
    flow4d__sample(sampler, p, to, time, b);
    for (i = 0; i < 3; i++) {
        slope[i] = (b[i] - a[i]) / (to[axis] - from[axis]);
    }
}

void flow4d_vorticity(const flow4d_sampler *sampler, const double position[3], double time,
                      double vorticity[3]) {
    const double *g = sampler->from_world;
    double index[3], slope[3][3], d[3][3];
    int i, j;
    flow4d__apply(g, position, index);
    if (!flow4d__finite(index, 3) || !flow4d__number(time)) {
        flow4d_sample(sampler, position, time, vorticity); /* NaN */
        return;
    }
    for (i = 0; i < 3; i++) {
        flow4d__difference(sampler, index, i, time, slope[i]);
    }
    for (i = 0; i < 3; i++) { /* d[i][j] = dv_i / dx_j */
        for (j = 0; j < 3; j++) {
            d[i][j] = slope[0][i] * g[j] + slope[1][i] * g[4 + j] + slope[2][i] * g[8 + j];
        }
    }
    vorticity[0] = 1000.0 * (d[2][1] - d[1][2]); /* 1/ms to 1/s */
    vorticity[1] = 1000.0 * (d[0][2] - d[2][0]);
    vorticity[2] = 1000.0 * (d[1][0] - d[0][1]);
}

static double flow4d__length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Times at which a function is looked at for its greatest speed. */
static uint32_t flow4d__looks(const flow4d_field *field) {
    if (!field->velocity_at) {
        return field->frame_count;
    }
    return !(field->period > 0.0) ? 1u : field->frame_count ? field->frame_count : 16u;
}

/* Greatest speed at a voxel over the cycle, 0 where there is none. */
static double flow4d__peak(const flow4d_sampler *sampler, const size_t voxel[3]) {
    const flow4d_field *field = &sampler->field;
    size_t row = voxel[0] + field->size[0] * (voxel[1] + field->size[1] * voxel[2]);
    size_t voxels = (size_t)field->size[0] * field->size[1] * field->size[2];
    uint32_t f, looks = flow4d__looks(field);
    double peak = 0.0, index[3], position[3];
    index[0] = (double)voxel[0];
    index[1] = (double)voxel[1];
    index[2] = (double)voxel[2];
    flow4d__apply(field->to_world, index, position);
    for (f = 0; f < looks; f++) {
        double v[3], speed;
        if (field->velocity_at) {
            field->velocity_at(field->user, position, field->period * f / looks, v);
        } else {
            const float *w = field->velocity + 3 * (f * voxels + row);
            v[0] = (double)w[0];
            v[1] = (double)w[1];
            v[2] = (double)w[2];
        }
        speed = flow4d__length(v);
        if (speed > peak && flow4d__number(speed)) {
            peak = speed;
        }
    }
    return peak;
}

double flow4d_max_speed(const flow4d_sampler *sampler) {
    const flow4d_field *field = &sampler->field;
    double greatest = 0.0;
    size_t v[3];
    for (v[2] = 0; v[2] < field->size[2]; v[2]++) {
        for (v[1] = 0; v[1] < field->size[1]; v[1]++) {
            for (v[0] = 0; v[0] < field->size[0]; v[0]++) {
                double index[3], position[3], peak;
                index[0] = (double)v[0];
                index[1] = (double)v[1];
                index[2] = (double)v[2];
                flow4d__apply(field->to_world, index, position);
                if (!flow4d__inside(sampler, position, index, FLOW4D_MASK_NEAREST)) {
                    continue;
                }
                peak = flow4d__peak(sampler, v);
                greatest = peak > greatest ? peak : greatest;
            }
        }
    }
    return greatest;
}

typedef struct flow4d__resampling {
    flow4d_sampler source;
    const flow4d_field *target;
    float *velocity;
    uint8_t *mask;
} flow4d__resampling;

/* One slice of one frame. */
static void flow4d__resample_slice(void *arg, size_t slice) {
    const flow4d__resampling *r = (const flow4d__resampling *)arg;
    const uint32_t *size = r->target->size;
    size_t voxel = slice * size[0] * size[1];
    size_t frame = slice / size[2];
    double time = r->target->period * (double)frame / r->target->frame_count;
    uint32_t x, y;
    for (y = 0; y < size[1]; y++) {
        for (x = 0; x < size[0]; x++, voxel++) {
            double index[3], position[3], source[3], v[3] = {0.0, 0.0, 0.0};
            index[0] = x;
            index[1] = y;
            index[2] = (double)(slice % size[2]);
            flow4d__apply(r->target->to_world, index, position);
            flow4d__apply(r->source.from_world, position, source);
            if (flow4d__inside(&r->source, position, source, FLOW4D_MASK_NEAREST)) {
                flow4d__sample(&r->source, position, source, time, v);
            }
            r->velocity[3 * voxel] = (float)v[0];
            r->velocity[3 * voxel + 1] = (float)v[1];
            r->velocity[3 * voxel + 2] = (float)v[2];
            if (r->mask && slice < size[2]) {
                r->mask[voxel] =
                    (uint8_t)flow4d__inside(&r->source, position, source, FLOW4D_MASK_NEAREST);
            }
        }
    }
}

lao_result flow4d_resample(const flow4d_host *host, const flow4d_field *source,
                           const flow4d_field *target, float *velocity, uint8_t *mask) {
    flow4d_host h = flow4d__host(host);
    flow4d__resampling r;
    flow4d_field lattice;
    double unused[12];
    lao_result result;
    if (!target || !velocity) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "target or velocity of flow4d_resample");
    }
    lattice = *target;
    lattice.velocity_at = NULL; /* an array is wanted, so frame_count matters */
    result = flow4d_sampler_make(&h, source, &r.source);
    if (result == LAO_OK) {
        result = flow4d__domain_check(&h, &lattice, unused);
    }
    if (result != LAO_OK) {
        return result;
    }
    r.target = target;
    r.velocity = velocity;
    r.mask = mask;
    return flow4d__work(&h, "flow4d_resample", (size_t)target->size[2] * target->frame_count,
                        flow4d__resample_slice, &r);
}

typedef struct flow4d__maximum {
    flow4d_sampler sampler;
    float *values;
} flow4d__maximum;

static void flow4d__maximum_slice(void *arg, size_t z) {
    const flow4d__maximum *m = (const flow4d__maximum *)arg;
    const uint32_t *size = m->sampler.field.size;
    size_t v[3], i = z * size[0] * size[1];
    v[2] = z;
    for (v[1] = 0; v[1] < size[1]; v[1]++) {
        for (v[0] = 0; v[0] < size[0]; v[0]++) {
            m->values[i++] = (float)flow4d__peak(&m->sampler, v);
        }
    }
}

lao_result flow4d_temporal_maximum(const flow4d_host *host, const flow4d_field *field,
                                   float *values) {
    flow4d_host h = flow4d__host(host);
    flow4d__maximum m;
    lao_result result;
    if (!values) {
        return flow4d__fail(&h, FLOW4D_LOG_NULL_ARGUMENT, "values of flow4d_temporal_maximum");
    }
    result = flow4d_sampler_make(&h, field, &m.sampler);
    if (result != LAO_OK) {
        return result;
    }
    m.values = values;
    return flow4d__work(&h, "flow4d_temporal_maximum", field->size[2], flow4d__maximum_slice, &m);
}
