// Curvatures of CGAL at the vertices of an OFF file, with CGAL's own normals and sizes. The first line names the
// columns, and each other line is a vertex. What this version of CGAL does not have has no column.
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#if __has_include(<CGAL/Polygon_mesh_processing/interpolated_corrected_curvatures.h>)
#include <CGAL/Polygon_mesh_processing/interpolated_corrected_curvatures.h>
#define HAS_CORRECTED
#endif
#if __has_include(<CGAL/Polygon_mesh_processing/curvature.h>)
#include <CGAL/Polygon_mesh_processing/curvature.h>
#define HAS_DISCRETE
#endif

#include <cstdio>
#include <fstream>
#include <set>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

// A vertex and its neighbours up to two edges away.
static std::vector<Kernel::Point_3> near(const Mesh &mesh, Mesh::Vertex_index vertex) {
    std::set<Mesh::Vertex_index> found{vertex};
    for (int ring = 0; ring < 2; ++ring) {
        const std::set<Mesh::Vertex_index> last = found;
        for (const auto v : last)
            for (const auto w : vertices_around_target(halfedge(v, mesh), mesh)) found.insert(w);
    }
    found.erase(vertex);
    std::vector<Kernel::Point_3> points{mesh.point(vertex)};
    for (const auto v : found) points.push_back(mesh.point(v));
    return points;
}

int main(int, char **arguments) {
    Mesh mesh;
    std::ifstream file(arguments[1]);
    if (!(file >> mesh)) return 1;
    std::printf("jet_k0 jet_k1");
#ifdef HAS_CORRECTED
    std::printf(" corrected_H corrected_K");
    const auto H = mesh.add_property_map<Mesh::Vertex_index, double>("H", 0).first;
    const auto K = mesh.add_property_map<Mesh::Vertex_index, double>("K", 0).first;
    processing::interpolated_corrected_curvatures(
        mesh, CGAL::parameters::vertex_mean_curvature_map(H).vertex_Gaussian_curvature_map(K));
#endif
#ifdef HAS_DISCRETE
    std::printf(" discrete_H discrete_K");
#endif
    std::printf("\n");
    for (const auto v : vertices(mesh)) {
        const auto points = near(mesh, v);
        CGAL::Monge_via_jet_fitting<Kernel> fitting;
        auto jet = fitting(points.begin(), points.end(), 4, 2);
        jet.comply_wrt_given_normal(processing::compute_vertex_normal(v, mesh));
        std::printf("%.17g %.17g", jet.principal_curvatures(0), jet.principal_curvatures(1));
#ifdef HAS_CORRECTED
        std::printf(" %.17g %.17g", H[v], K[v]);
#endif
#ifdef HAS_DISCRETE
        std::printf(" %.17g %.17g", processing::discrete_mean_curvature(v, mesh),
                    processing::discrete_Gaussian_curvature(v, mesh));
#endif
        std::printf("\n");
    }
}
