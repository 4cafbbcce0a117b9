/* Calls every function with arguments of all kinds: NULL, wrong counts, NaN, misaligned and overlapping arrays, texts
 * that are none. No call may crash, and a status is one of those of the header. Run under valgrind and with the
 * address sanitizer.
 *
 *     hostile ROUNDS SEED */
#include "helfrich.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef double point[3];
typedef float point_f32[3];

/* An octahedron, open if its last triangle is left out. */
enum { N = 6, M = 8, EDGES = 12, ENTRIES = N + 2 * EDGES };
static const uint32_t TRIANGLES[M][3] = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                         {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
static const double POINTS[N][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};

static uint64_t state;

/* xorshift64*: S. Vigna, ACM Trans. Math. Softw. 42 (2016) 30. */
static uint32_t any(uint32_t below) {
    state ^= state >> 12, state ^= state << 25, state ^= state >> 27;
    return (uint32_t)((state * 2685821657736338717u) >> 33) % below;
}

static double number(void) {
    static const double KINDS[] = {0.0, -1.0, 1e-300, 1e300, 1e-30, 5.0};
    switch (any(12)) {
    case 0: return NAN;
    case 1: return INFINITY;
    case 2: return KINDS[any(6)];
    default: return any(1000) / 500.0 - 1.0;
    }
}

/* Memory for the arrays of a call: blocks of their exact size, which valgrind watches; sometimes the block of the
 * positions again, sometimes misaligned or NULL. They live until the next call. */
enum { BLOCKS = 64 };
static void *blocks[BLOCKS];
static int used;
static void *shared;
static void release(void) {
    shared = NULL;
    while (used > 0) free(blocks[--used]);
}

static void *block(size_t bytes) {
    if (used == BLOCKS) exit(1);
    blocks[used] = calloc(1, bytes);
    if (blocks[used] == NULL) exit(1);
    return blocks[used++];
}

static void *memory(size_t bytes) {
    switch (any(24)) {
    case 0: return NULL;
    case 1: return shared != NULL ? shared : block(bytes);
    case 2: return (char *)block(bytes + 8) + 1 + any(7);
    default: return block(bytes);
    }
}

/* `rows` rows of numbers of `width` entries, double or float. */
static void *rows(size_t rows, size_t width, int narrow) {
    return memory(rows * width * (narrow ? sizeof(float) : sizeof(double)));
}

/* Positions of the octahedron, most of them finite. */
static void *positions(int narrow) {
    shared = NULL;
    void *place = rows(2 * N, 3, narrow);
    shared = place;
    for (int k = 0; place != NULL && k < 3 * N; k++) {
        const double value = POINTS[k / 3][k % 3] + (any(4) ? 0.01 * any(10) : any(30) ? 0.0 : number());
        const float single = (float)value;
        if (narrow) memcpy((char *)place + k * sizeof single, &single, sizeof single);
        else memcpy((char *)place + k * sizeof value, &value, sizeof value);
    }
    return place;
}

/* Weights of corners, most of them with the sum 1. */
static void *weights(int narrow) {
    void *place = rows(N, 3, narrow);
    for (int k = 0; place != NULL && place != shared && k < 3 * N; k++) {
        const double value = any(60) == 0 ? number() : k % 3 == 1 ? 0.5 : 0.25;
        const float single = (float)value;
        if (narrow) memcpy((char *)place + k * sizeof single, &single, sizeof single);
        else memcpy((char *)place + k * sizeof value, &value, sizeof value);
    }
    return place;
}

static size_t count(size_t right) {
    static const size_t WRONG[] = {0, 1, (size_t)-1, (size_t)-1 / 8, (size_t)1 << 40};
    switch (any(12)) {
    case 0: return WRONG[any(5)];
    case 1: return right - 1;
    case 2: return right + 1;
    default: return right;
    }
}

static const char *text(void) {
    static const char *TEXTS[] = {
        "bending = { method = \"gompper-kroll\", modulus = 1.0 }",
        "bending = { method = \"j6\", modulus = 1.0 }\nvolume = { modulus = 1.0 }",
        "volume = { constraint = \"exact\" }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1.0 }",
        "bending = { method = \"A\", modulus = { column = \"kappa\" } }",
        "bending = { method = \"B\", modulus = { column = \"kappa\" } }\nlocal_area = { modulus = 1.0 }",
        "elasticity = { law = \"skalak\", shear_modulus = 1e300, area_ratio = 1e300 }",
        "area = { modulus = 1e-300 }\ntension = { value = -1e200 }", "gravity = {}", "shape = 3", "units = \"micro\"",
        "", "[", "\xff\xfe", "bending = \"\\u0000\"", "stretching = { force = 1.0 }", "jet", "meyer", "corrected-fit",
        "mixed", "voronoi", "/", "no such file.off",
    };
    const uint32_t which = any(any(2) ? 5 : sizeof TEXTS / sizeof *TEXTS + 1);
    return which < sizeof TEXTS / sizeof *TEXTS ? TEXTS[which] : NULL;
}

static hf_error error;
static hf_error *report(void) { return any(4) ? &error : NULL; }

static unsigned long outcomes[HF_STATUS_INTERNAL + 1];
static void count_outcome(hf_status status) {
    if (status < HF_STATUS_OK || status >= HF_STATUS_INTERNAL) {
        fprintf(stderr, "status %d: %s\n", (int)status, error.text);
        exit(1);
    }
    outcomes[status]++;
}

static void *fields(int narrow) {
    static hf_fields own;
    static hf_fields_f32 own_f32;
    own = (hf_fields){rows(N, 1, 0), rows(N, 3, 0), rows(N, 1, 0), rows(N, 1, 0), rows(N, 1, 0), rows(N, 3, 0), rows(N, 1, 1)};
    own_f32 = (hf_fields_f32){rows(N, 1, 1), rows(N, 3, 1), rows(N, 1, 1), rows(N, 1, 1), rows(N, 1, 1), rows(N, 3, 1), rows(N, 1, 1)};
    return any(20) == 0 ? NULL : narrow ? (void *)&own_f32 : (void *)&own;
}

static void *measured(int narrow) {
    static hf_measured own;
    static hf_measured_f32 own_f32;
    own = (hf_measured){rows(N, 1, 0), NULL, rows(N, 1, 0), NULL,
                  rows(N, 2, 0), NULL, rows(N, 6, 0), rows(N, 1, 0), NULL, NULL, NULL, rows(N, 1, 1)};
    own_f32 = (hf_measured_f32){rows(N, 1, 1), NULL, rows(N, 1, 1), NULL,
                  rows(N, 2, 1), NULL, rows(N, 6, 1), rows(N, 1, 1), NULL, NULL, NULL, rows(N, 1, 1)};
    return any(20) == 0 ? NULL : narrow ? (void *)&own_f32 : (void *)&own;
}

static void *points(int narrow) {
    static hf_surface_points own;
    static hf_surface_points_f32 own_f32;
    own = (hf_surface_points){rows(N, 3, 0), rows(N, 1, 0), NULL, rows(N, 1, 0), NULL, rows(N, 1, 0), NULL, rows(N, 2, 0), NULL};
    own_f32 = (hf_surface_points_f32){rows(N, 3, 1), NULL, rows(N, 3, 1), rows(N, 1, 1), NULL, NULL, rows(N, 1, 1), NULL, rows(N, 3, 1)};
    return any(20) == 0 ? NULL : narrow ? (void *)&own_f32 : (void *)&own;
}

static hf_surface *surface_of(const hf_mesh *mesh, const void *x, int narrow) {
    hf_surface *surface = NULL;
    const uint32_t degree = 2 * any(5);
    count_outcome(narrow ? hf_surface_new_f32(mesh, x, count(N), degree, any(3), &surface, report())
                         : hf_surface_new(mesh, x, count(N), degree, any(3), &surface, report()));
    return surface;
}

static hf_mesh *remeshed(const hf_mesh *mesh, const void *x, int narrow) {
    hf_mesh *made = NULL;
    const hf_remeshing wanted = {any(3) * N, any(3) ? 0.0 : number(), any(4) ? 60.0 : number(), any(3)};
    const hf_remeshing *asked = any(20) ? &wanted : NULL;
    /* Lengths far below those of the mesh ask for more vertices than memory holds. */
    if (wanted.edge > 0.0 && wanted.edge < 0.3) asked = NULL;
    count_outcome(narrow ? hf_remesh_f32(mesh, x, count(N), asked, any(3), &made, report())
                         : hf_remesh(mesh, x, count(N), asked, any(3), &made, report()));
    return made;
}

static void call(hf_mesh *mesh, hf_membrane **membranes, hf_method *method) {
    hf_membrane *membrane = any(30) ? membranes[0] : NULL;
    const hf_mesh *of = any(30) ? mesh : NULL;
    const size_t effects = hf_membrane_effect_count(membrane), n = N;
    const size_t constraints = hf_membrane_constraint_count(membrane);
    hf_membrane *list[3] = {membranes[0], membranes[any(2)], any(10) ? membranes[0] : NULL};
    const size_t several = any(3);
    /* As many points as are asked for: no count is wrong, unless it is beyond the arrays. */
    const size_t few = any(N + 1);
    const size_t room = any(200);
    char *words = any(20) ? block(room + 1) : NULL;
    uint32_t *places = memory(N * sizeof *places);
    for (int k = 0; places != NULL && k < N; k++) {
        const uint32_t place = any(20) ? any(N + 2) : any(1000000);
        memcpy((char *)places + k * sizeof place, &place, sizeof place);
    }
    const hf_mesh *meshes[3] = {mesh, any(20) ? mesh : NULL, mesh};
    const double box[2][3] = {{8.0, 0.0, 8.0}, {8.0, any(4) ? 8.0 : number(), 0.5}};
    const double *periods = any(2) ? NULL : box[any(2)];
    const float periods_f32[3] = {8.0f, 0.0f, any(4) ? 8.0f : 0.5f};
    const uint32_t which = any(53);
    const int narrow = which % 2;
    void *x = positions(narrow);
    hf_surface *smooth = which < 45 || any(30) == 0 ? NULL : surface_of(of, x, narrow);
    switch (which) {
    case 0: count_outcome(hf_mesh_triangles(of, rows(M, 3, 1), count(M), report())); break;
    case 1: count_outcome(hf_mesh_positions_f32(of, rows(N, 3, 1), count(n), report())); break;
    case 2: count_outcome(hf_mesh_positions(of, rows(N, 3, 0), count(n), report())); break;
    case 3: count_outcome(hf_area_f32(of, x, count(n), rows(1, 1, 1), report())); break;
    case 4: count_outcome(hf_area(of, x, count(n), rows(1, 1, 0), report())); break;
    case 5: count_outcome(hf_volume_f32(of, x, count(n), rows(1, 1, 1), report())); break;
    case 6: count_outcome(hf_volume(of, x, count(n), rows(1, 1, 0), report())); break;
    case 7: count_outcome(hf_membrane_energy_f32(membrane, x, count(n), rows(1, 1, 1), report())); break;
    case 8: count_outcome(hf_membrane_energy(membrane, x, count(n), rows(1, 1, 0), report())); break;
    case 9: count_outcome(hf_membrane_force_f32(membrane, x, count(n), rows(N, 3, 1), rows(1, 1, 1), report())); break;
    case 10: count_outcome(hf_membrane_force(membrane, x, count(n), rows(N, 3, 0), rows(1, 1, 0), report())); break;
    case 11: count_outcome(hf_membrane_effect_forces_f32(membrane, x, count(n), rows(effects, 1, 1), any(2) ? NULL : rows(effects * N, 3, 1), count(effects), report())); break;
    case 12: count_outcome(hf_membrane_effect_forces(membrane, x, count(n), rows(effects, 1, 0), NULL, count(effects), report())); break;
    case 13: count_outcome(hf_membrane_add_force_at_f32(membrane, places, count(n), x, n + any(2), any(n + 2), rows(2 * N, 3, 1), rows(1, 1, 1), report())); break;
    case 14: count_outcome(hf_membrane_add_force_at(membrane, places, count(n), x, n + any(2), any(n + 2), rows(2 * N, 3, 0), rows(1, 1, 0), report())); break;
    case 15: count_outcome(hf_membrane_warnings(membrane, words, room, report())); break;
    case 16: count_outcome(hf_membrane_constraint_gradients(membrane, x, count(n), rows(constraints * N, 3, 0), count(constraints), report())); break;
    case 18: count_outcome(hf_membrane_restore(membrane, x, count(n), rows(1, 1, 0), report())); break;
    case 19: count_outcome(hf_membranes_force_f32((hf_membrane *const *)list, several, x, rows(2 * N, 3, 1), any(4) ? several * n : any(3) * n / 2, rows(2, 1, 1), any(4), report())); break;
    case 20: count_outcome(hf_membranes_force((hf_membrane *const *)list, several, x, rows(2 * N, 3, 0), any(4) ? several * n : any(3) * n / 2, rows(2, 1, 0), any(4), report())); break;
    case 21: count_outcome(hf_method_fields_f32(any(30) ? method : NULL, x, count(n), fields(1), report())); break;
    case 22: count_outcome(hf_method_fields(any(30) ? method : NULL, x, count(n), fields(0), report())); break;
    case 23: count_outcome(hf_measure_f32(of, x, count(n), number(), any(3), measured(1), report())); break;
    case 24: count_outcome(hf_measure(of, x, count(n), number(), any(3), measured(0), report())); break;
    case 25: count_outcome(hf_stiffness_f32(of, x, count(n), memory((N + 1) * sizeof(size_t)), memory(ENTRIES * sizeof(size_t)), rows(ENTRIES, 1, 1), count(ENTRIES), report())); break;
    case 26: count_outcome(hf_stiffness(of, x, count(n), memory((N + 1) * sizeof(size_t)), memory(ENTRIES * sizeof(size_t)), rows(ENTRIES, 1, 0), count(ENTRIES), report())); break;
    case 27: count_outcome(hf_mass_f32(of, x, count(n), memory((N + 1) * sizeof(size_t)), memory(ENTRIES * sizeof(size_t)), rows(ENTRIES, 1, 1), count(ENTRIES), report())); break;
    case 28: count_outcome(hf_mass(of, x, count(n), memory((N + 1) * sizeof(size_t)), memory(ENTRIES * sizeof(size_t)), rows(ENTRIES, 1, 0), count(ENTRIES), report())); break;
    case 29: count_outcome(hf_vertex_areas_f32(of, x, count(n), text(), rows(N, 1, 1), report())); break;
    case 30: count_outcome(hf_vertex_areas(of, x, count(n), text(), rows(N, 1, 0), report())); break;
    case 31: count_outcome(hf_gradient_f32(of, x, count(n), rows(N, 1, 1), rows(M, 3, 1), count(M), report())); break;
    case 32: count_outcome(hf_gradient(of, x, count(n), rows(N, 1, 0), rows(M, 3, 0), count(M), report())); break;
    case 33: count_outcome(hf_method_name(any(30), words, room, report())); break;
    case 34: count_outcome(hf_effect_name(any(30), words, room, report())); break;
    case 35: count_outcome(hf_flag_name(any(30), words, room, report())); break;
    case 36: count_outcome(hf_verdict_name(any(8), words, room, report())); break;
    case 37: count_outcome(hf_membrane_effect_name(membrane, any(4), words, room, report())); break;
    case 38: count_outcome(hf_viscous_force_f32(of, x, positions(1), count(n), any(4) ? 1.0f : (float)number(), 0.5f, rows(N, 3, 1), rows(1, 1, 1), report())); break;
    case 39: count_outcome(hf_viscous_force(of, x, positions(0), count(n), 1.0, any(4) ? 0.5 : number(), rows(N, 3, 0), any(2) ? NULL : rows(1, 1, 0), report())); break;
    case 40: count_outcome(hf_repulsion(any(20) ? meshes : NULL, several, x, rows(2 * N, 3, 0), any(4) ? several * n : any(3) * n / 2, 1.0, any(4) ? 1.0 : number(), (void *)periods, rows(1, 1, 0), any(4), report())); break;
    case 41: count_outcome(hf_repulsion_f32(any(20) ? meshes : NULL, several, x, rows(2 * N, 3, 1), any(4) ? several * n : any(3) * n / 2, any(4) ? 1.0f : (float)number(), 1.0f, any(2) ? NULL : (void *)periods_f32, any(2) ? NULL : rows(1, 1, 1), any(4), report())); break;
    case 45: count_outcome(hf_surface_at_f32(smooth, places, weights(1), few, any(3), points(1), report())); break;
    case 46: count_outcome(hf_surface_at(smooth, places, weights(0), few, any(3), points(0), report())); break;
    case 47: count_outcome(hf_surface_project_f32(smooth, rows(N, 3, 1), few, any(3), places, rows(N, 3, 1), report())); break;
    case 48: count_outcome(hf_surface_project(smooth, rows(N, 3, 0), few, any(3), places, rows(N, 3, 0), report())); break;
    case 49: count_outcome(hf_surface_interpolate_f32(smooth, rows(N, 1, 1), count(n), places, weights(1), few, any(3), rows(N, 1, 1), NULL, report())); break;
    case 50: count_outcome(hf_surface_interpolate(smooth, rows(N, 1, 0), count(n), places, weights(0), few, any(3), rows(N, 1, 0), rows(N, 1, 0), report())); break;
    case 51: case 52: hf_mesh_free(remeshed(of, x, narrow)); break;
    default:
        if (strlen(hf_status_text((int)any(100) - 50)) == 0 || strlen(hf_version()) == 0) exit(1);
    }
    hf_surface_free(smooth);
}

int main(int argc, char **argv) {
    const long rounds = argc > 1 ? atol(argv[1]) : 1000;
    state = argc > 2 ? (uint64_t)atol(argv[2]) : 1;
    for (long round = 0; round < rounds; round++) {
        uint32_t triangles[M][3];
        memcpy(triangles, TRIANGLES, sizeof triangles);
        if (any(6) == 0) triangles[any(M)][any(3)] = any(10) ? any(N) : any(1u << 31);
        hf_mesh *mesh = NULL, *read = NULL;
        hf_membrane *membranes[2] = {NULL, NULL};
        hf_method *method = NULL;
        count_outcome(hf_mesh_new(any(20) ? N : any(N), any(50) ? triangles : NULL, any(5) ? M : any(M + 1),
                                  any(50) ? &mesh : NULL, report()));
        count_outcome(hf_mesh_read(text(), any(2), any(50) ? &read : NULL, report()));
        release();
        double kappa[M] = {1.0, 1.0, number(), 1.0, 1.0, 1.0, 1.0, 1.0};
        hf_values values[2] = {{any(20) ? "kappa" : text(), any(20) ? kappa : NULL, any(2) ? N : M},
                               {text(), kappa, any(N + 1)}};
        for (int k = 0; k < 2; k++) {
            if (any(2))
                count_outcome(hf_membrane_new(mesh, positions(0), count(N), text(), any(20) ? values : NULL, any(3),
                                              any(3), any(50) ? &membranes[k] : NULL, report()));
            else
                count_outcome(hf_membrane_new_f32(mesh, positions(1), count(N), text(), any(20) ? values : NULL,
                                                  any(3), any(3), any(50) ? &membranes[k] : NULL, report()));
        }
        release();
        count_outcome(hf_method_new(mesh, text(), any(4) ? NULL : text(), any(4) ? NULL : text(), any(4) ? 1.0 : number(), any(4) ? 0.0 : number(), any(3),
                                    any(50) ? &method : NULL, report()));
        for (int k = 0; k < 20; k++) {
            call(mesh, membranes, method);
            release();
        }
        hf_mesh_free(mesh), hf_mesh_free(read), hf_method_free(method);
        hf_membrane_free(membranes[0]), hf_membrane_free(membranes[1]);
    }
    for (int status = 0; status < HF_STATUS_INTERNAL; status++)
        printf("%-40s %8lu\n", hf_status_text(status), outcomes[status]);
    return 0;
}
