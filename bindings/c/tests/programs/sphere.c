/* Writes a mesh of the unit sphere in OFF: an octahedron, divided four times. */
#include <math.h>
#include <stdio.h>

enum { LEVELS = 4, VERTICES = 1026, TRIANGLES = 2048 };

static double points[VERTICES][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
static int triangles[TRIANGLES][3] = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                      {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
static int ends[VERTICES][2];
static int vertices = 6, count = 8;

/* The vertex in the middle of an edge, which the two triangles at it share. */
static int middle(int a, int b, int first) {
    const int low = a < b ? a : b, high = a < b ? b : a;
    for (int k = first; k < vertices; k++)
        if (ends[k][0] == low && ends[k][1] == high) return k;
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        const double sum = points[a][axis] + points[b][axis];
        points[vertices][axis] = sum;
        square += sum * sum;
    }
    for (int axis = 0; axis < 3; axis++) points[vertices][axis] /= sqrt(square);
    ends[vertices][0] = low, ends[vertices][1] = high;
    return vertices++;
}

int main(void) {
    for (int level = 0; level < LEVELS; level++) {
        const int coarse = count, first = vertices;
        for (int t = 0; t < coarse; t++) {
            const int a = triangles[t][0], b = triangles[t][1], c = triangles[t][2];
            const int ab = middle(a, b, first), bc = middle(b, c, first), ca = middle(c, a, first);
            const int finer[4][3] = {{ab, bc, ca}, {a, ab, ca}, {b, bc, ab}, {c, ca, bc}};
            for (int k = 0; k < 4; k++)
                for (int corner = 0; corner < 3; corner++)
                    triangles[k == 0 ? t : count + k - 1][corner] = finer[k][corner];
            count += 3;
        }
    }
    printf("OFF\n%d %d 0\n", vertices, count);
    for (int k = 0; k < vertices; k++) printf("%.17g %.17g %.17g\n", points[k][0], points[k][1], points[k][2]);
    for (int t = 0; t < count; t++) printf("3 %d %d %d\n", triangles[t][0], triangles[t][1], triangles[t][2]);
    return 0;
}
