/* Use of the C interface, as C11 and as C++17: a sphere, whose bending energy is known. Prints the energy and the
 * forces bit by bit, so that builds can be compared. */
#include "helfrich.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static void check(hf_status status, const hf_error *error) {
    if (status != HF_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", hf_status_text(status), error->text);
        exit(1);
    }
}

static void require(int condition, const char *what) {
    if (!condition) {
        fprintf(stderr, "not true: %s\n", what);
        exit(1);
    }
}

static void *array(size_t count, size_t size) {
    void *memory = calloc(count, size);
    require(memory != NULL, "there is memory");
    return memory;
}

typedef double point[3];
typedef float point_f32[3];
typedef uint32_t triangle[3];

int main(int argc, char **argv) {
    hf_error error;
    hf_mesh *mesh = NULL;
    require(argc == 2, "the mesh of a unit sphere is given");
    require(hf_abi_version() == HF_ABI_VERSION, "header and library are of one version");
    check(hf_mesh_read(argv[1], 0, &mesh, &error), &error);
    const size_t n = hf_mesh_vertex_count(mesh), m = hf_mesh_triangle_count(mesh);
    point *x = (point *)array(n, sizeof *x), *force = (point *)array(n, sizeof *force);
    check(hf_mesh_positions(mesh, x, n, &error), &error);

    /* A mesh of triangles alone is the same mesh. */
    triangle *triangles = (triangle *)array(m, sizeof *triangles);
    hf_mesh *same = NULL;
    check(hf_mesh_triangles(mesh, triangles, m, &error), &error);
    check(hf_mesh_new(n, triangles, m, &same, &error), &error);
    require(hf_mesh_positions(same, x, n, NULL) == HF_STATUS_UNDEFINED, "it has no positions");
    hf_mesh_free(same);

    /* E = 8 pi kappa. The areas of a sphere's triangles are too small by up to a hundredth on this mesh. */
    hf_membrane *membrane = NULL;
    const char *effects = "bending = { method = \"j6\", modulus = 2.0 }\n"
                          "elasticity = { law = \"skalak\", shear_modulus = 3.0, area_ratio = 1.0 }\n";
    check(hf_membrane_new(mesh, (const point *)x, n, effects, NULL, 0, 0, &membrane, &error), &error);
    double energy = 0.0, sum[3] = {0.0, 0.0, 0.0};
    check(hf_membrane_force(membrane, (const point *)x, n, force, &energy, &error), &error);
    require(fabs(energy / (16.0 * PI) - 1.0) < 1e-2, "the energy is that of a sphere");
    for (size_t k = 0; k < 3 * n; k++) sum[k % 3] += force[k / 3][k % 3];
    require(fabs(sum[0]) + fabs(sum[1]) + fabs(sum[2]) < 1e-9, "forces sum to zero");
    printf("energy %a\n", energy);
    for (size_t k = 0; k < n; k++) printf("%a %a %a\n", force[k][0], force[k][1], force[k][2]);
    char name[64];
    check(hf_membrane_effect_name(membrane, 1, name, sizeof name, &error), &error);
    require(strcmp(name, "elasticity") == 0, "effects have the names of their keys");

    /* float: H = 1 at every vertex. */
    point_f32 *x32 = (point_f32 *)array(n, sizeof *x32);
    float *mean = (float *)array(n, sizeof *mean);
    uint32_t *flags = (uint32_t *)array(n, sizeof *flags);
    hf_method *method = NULL;
    hf_fields_f32 fields;
    memset(&fields, 0, sizeof fields);
    fields.mean = mean;
    fields.flags = flags;
    check(hf_mesh_positions_f32(mesh, x32, n, &error), &error);
    check(hf_method_new(mesh, "jet", NULL, NULL, 1.0, 0.0, 1, &method, &error), &error);
    check(hf_method_fields_f32(method, (const point_f32 *)x32, n, &fields, &error), &error);
    for (size_t k = 0; k < n; k++) {
        require(fabsf(mean[k] - 1.0f) < 1e-3f, "H of a unit sphere is 1, and positive");
        require((flags[k] & HF_NO_MEAN) == 0, "H is defined");
    }

    /* A mistake has a text. */
    hf_membrane *none = NULL;
    require(hf_membrane_new(mesh, (const point *)x, n, "bendin = 1", NULL, 0, 1, &none, &error) ==
                HF_STATUS_INVALID_EFFECTS, "an unknown effect is refused");
    require(none == NULL && strstr(error.text, "did you mean `bending`") != NULL, "the text helps");

    hf_method_free(method);
    hf_membrane_free(membrane);
    hf_mesh_free(mesh);
    hf_mesh_free(NULL);
    free(x), free(force), free(triangles), free(x32), free(mean), free(flags);
    return 0;
}
