/* C interface of helfrich: bending of triangulated membranes.
 *
 * Conventions: triangles run counter-clockwise seen from outside, and normals point outward. H = (k1 + k2)/2
 * is positive on a sphere. A force is nodal, -dE/dx, in units of force; a force density is a force per area.
 * Numbers have the units of the caller. Arrays belong to the caller and are densely packed: `count` rows
 * of three coordinates. In the twins whose names end with _f32 positions are widened exactly, everything is
 * computed in double, and results are rounded once. Forces, energies and matrices beyond the range of their type
 * are an error, HF_STATUS_UNDEFINED; curvatures and force densities are infinite there.
 *
 * Every function that can fail returns a status and takes a pointer to an hf_error, or NULL. A call that
 * fails leaves its handles usable, and its output arrays in any state. Arrays of one call must not overlap,
 * unless both are only read. Handles are freed once, by the function that is named where they are made.
 * Nothing is global: several threads may use different handles, and the same mesh. */


#ifndef HELFRICH_H
#define HELFRICH_H

#include <stddef.h>
#include <stdint.h>

/*
 Version of this interface: it grows when a function, a type or the meaning of an argument changes.
 */
#define HF_ABI_VERSION 1

/*
 Bit of a vertex's flags beside those of findings: H is not defined there, and set to 0.
 */
#define HF_NO_MEAN (1 << 24)

/*
 As HF_NO_MEAN, for K.
 */
#define HF_NO_GAUSSIAN (1 << 25)

/*
 As HF_NO_MEAN, for Δ_S H.
 */
#define HF_NO_LAPLACIAN (1 << 26)

/*
 As HF_NO_MEAN, for the force density.
 */
#define HF_NO_DENSITY (1 << 27)

/*
 Number of bytes of the text of an error, with the zero byte at its end.
 */
#define HF_TEXT_BYTES 1020

/*
 The outcome of a call.
 */
typedef enum {
  /*
   The call has done what it says.
   */
  HF_STATUS_OK = 0,
  /*
   A pointer that is needed is NULL.
   */
  HF_STATUS_NULL_POINTER = 1,
  /*
   An array has another number of entries than the mesh or the call asks for.
   */
  HF_STATUS_INVALID_COUNT = 2,
  /*
   An argument is out of its range, misaligned, no text in UTF-8, or overlaps another one.
   */
  HF_STATUS_INVALID_ARGUMENT = 3,
  /*
   The triangles do not form an oriented manifold.
   */
  HF_STATUS_INVALID_MESH = 4,
  /*
   A coordinate is not finite, or too far away.
   */
  HF_STATUS_INVALID_POSITIONS = 5,
  /*
   The text of effects is wrong, or an effect cannot act on the mesh.
   */
  HF_STATUS_INVALID_EFFECTS = 6,
  /*
   A file cannot be read, or has no mesh.
   */
  HF_STATUS_UNREADABLE_FILE = 7,
  /*
   The result is not defined, such as the volume of an open surface, or beyond the numbers of its type.
   */
  HF_STATUS_UNDEFINED = 8,
  /*
   An error of the library itself: please report it. The handles of the call can only be freed.
   */
  HF_STATUS_INTERNAL = 9,
} hf_status;

/*
 Effects on one mesh, with the memory of their evaluations. One thread at a time may use it.
 */
typedef struct hf_membrane hf_membrane;

/*
 An oriented manifold of triangles, closed or with edges. It never changes, and several threads may use it.
 */
typedef struct hf_mesh hf_mesh;

/*
 A bending method, or an operator for curvatures, on one mesh. One thread at a time may use it.
 */
typedef struct hf_method hf_method;

/*
 The smooth surface through the vertices of a mesh. It never changes, and several threads may use it.
 */
typedef struct hf_surface hf_surface;

/*
 The error of a call, owned by the caller. A call that succeeds sets it to HF_STATUS_OK and an empty text.
 */
typedef struct {
  /*
   The status that the call returned.
   */
  hf_status status;
  /*
   The problem, its place, and what would be right: UTF-8, ended by a zero byte, and cut if it is long.
   */
  char text[HF_TEXT_BYTES];
} hf_error;

/*
 Arrays of the caller for curvatures with error bars at vertices: `count` entries each, or NULL where a result
 is not wanted. The true error is estimated to be within the error bar at 99 of 100 vertices. A value that is
 not known is 0, with an infinite error.
 */
typedef struct {
  /*
   Mean curvature H, 1/length, positive on a sphere.
   */
  double *mean;
  /*
   Error bar of H.
   */
  double *mean_error;
  /*
   Gaussian curvature K, 1/length².
   */
  double *gaussian;
  /*
   Error bar of K.
   */
  double *gaussian_error;
  /*
   Principal curvatures k1 ≥ k2, 1/length.
   */
  double (*principal)[2];
  /*
   Error bars of the principal curvatures.
   */
  double (*principal_error)[2];
  /*
   Unit vectors along k1 and k2; 0 near umbilics, where they are not known.
   */
  double (*directions)[2][3];
  /*
   f = 2[Δ_S H + 2H(H² − K)], the force density along the normal for κ = 1, 1/length³.
   */
  double *force_density;
  /*
   Error bar of the force density.
   */
  double *force_density_error;
  /*
   Outward unit normal; 0 where it is not known.
   */
  double (*normal)[3];
  /*
   Standard deviation of the noise along the normal, a length; 0 if none was found.
   */
  double *deviation;
  /*
   Verdict on the mesh around the vertex, by the numbers of hf_verdict_name.
   */
  uint32_t *verdict;
} hf_measured;

/*
 Arrays of the caller for curvatures with error bars at vertices: `count` entries each, or NULL where a result
 is not wanted. The true error is estimated to be within the error bar at 99 of 100 vertices. A value that is
 not known is 0, with an infinite error.
 */
typedef struct {
  /*
   Mean curvature H, 1/length, positive on a sphere.
   */
  float *mean;
  /*
   Error bar of H.
   */
  float *mean_error;
  /*
   Gaussian curvature K, 1/length².
   */
  float *gaussian;
  /*
   Error bar of K.
   */
  float *gaussian_error;
  /*
   Principal curvatures k1 ≥ k2, 1/length.
   */
  float (*principal)[2];
  /*
   Error bars of the principal curvatures.
   */
  float (*principal_error)[2];
  /*
   Unit vectors along k1 and k2; 0 near umbilics, where they are not known.
   */
  float (*directions)[2][3];
  /*
   f = 2[Δ_S H + 2H(H² − K)], the force density along the normal for κ = 1, 1/length³.
   */
  float *force_density;
  /*
   Error bar of the force density.
   */
  float *force_density_error;
  /*
   Outward unit normal; 0 where it is not known.
   */
  float (*normal)[3];
  /*
   Standard deviation of the noise along the normal, a length; 0 if none was found.
   */
  float *deviation;
  /*
   Verdict on the mesh around the vertex, by the numbers of hf_verdict_name.
   */
  uint32_t *verdict;
} hf_measured_f32;

/*
 A material parameter by a name, for `{ column = "name" }` in the text of effects.
 */
typedef struct {
  /*
   Its name, ended by a zero byte.
   */
  const char *name;
  /*
   One number for each vertex, or for each triangle.
   */
  const double *values;
  /*
   Number of values.
   */
  size_t count;
} hf_values;

/*
 Arrays of the caller for results at vertices: `count` entries each, or NULL where a result is not wanted.
 Values that are not defined are 0, and flagged.
 */
typedef struct {
  /*
   Mixed area of the vertex, length².
   */
  double *area;
  /*
   Outward unit normal; 0 where it is not defined.
   */
  double (*normal)[3];
  /*
   Mean curvature H = (k1 + k2)/2, 1/length, positive on a sphere.
   */
  double *mean;
  /*
   Gaussian curvature K = k1 k2, 1/length².
   */
  double *gaussian;
  /*
   Δ_S H, 1/length³.
   */
  double *laplacian_of_mean;
  /*
   Force density, force per area; for methods with nodal forces, these over the mixed area.
   */
  double (*force_density)[3];
  /*
   Kinds of findings that concern the vertex, by the bits of hf_flag_name, and HF_NO_MEAN and others.
   */
  uint32_t *flags;
} hf_fields;

/*
 Arrays of the caller for results at vertices: `count` entries each, or NULL where a result is not wanted.
 Values that are not defined are 0, and flagged.
 */
typedef struct {
  /*
   Mixed area of the vertex, length².
   */
  float *area;
  /*
   Outward unit normal; 0 where it is not defined.
   */
  float (*normal)[3];
  /*
   Mean curvature H = (k1 + k2)/2, 1/length, positive on a sphere.
   */
  float *mean;
  /*
   Gaussian curvature K = k1 k2, 1/length².
   */
  float *gaussian;
  /*
   Δ_S H, 1/length³.
   */
  float *laplacian_of_mean;
  /*
   Force density, force per area; for methods with nodal forces, these over the mixed area.
   */
  float (*force_density)[3];
  /*
   Kinds of findings that concern the vertex, by the bits of hf_flag_name, and HF_NO_MEAN and others.
   */
  uint32_t *flags;
} hf_fields_f32;

/*
 Arrays of the caller for points of a smooth surface: `count` entries each, or NULL where a result is not wanted.
 Curvatures that are not known are 0, with an infinite error.
 */
typedef struct {
  /*
   Position, a length.
   */
  double (*position)[3];
  /*
   Error bar of the position along the normal if the vertices are exact, a length; 0 at vertices.
   */
  double *position_error;
  /*
   Outward unit normal.
   */
  double (*normal)[3];
  /*
   Mean curvature H, 1/length, positive on a sphere.
   */
  double *mean;
  /*
   Estimated error of H.
   */
  double *mean_error;
  /*
   Gaussian curvature K, 1/length².
   */
  double *gaussian;
  /*
   Estimated error of K.
   */
  double *gaussian_error;
  /*
   Principal curvatures k1 ≥ k2, 1/length.
   */
  double (*principal)[2];
  /*
   Unit vector along k1; 0 at umbilics.
   */
  double (*direction)[3];
} hf_surface_points;

/*
 Arrays of the caller for points of a smooth surface: `count` entries each, or NULL where a result is not wanted.
 Curvatures that are not known are 0, with an infinite error.
 */
typedef struct {
  /*
   Position, a length.
   */
  float (*position)[3];
  /*
   Error bar of the position along the normal if the vertices are exact, a length; 0 at vertices.
   */
  float *position_error;
  /*
   Outward unit normal.
   */
  float (*normal)[3];
  /*
   Mean curvature H, 1/length, positive on a sphere.
   */
  float *mean;
  /*
   Estimated error of H.
   */
  float *mean_error;
  /*
   Gaussian curvature K, 1/length².
   */
  float *gaussian;
  /*
   Estimated error of K.
   */
  float *gaussian_error;
  /*
   Principal curvatures k1 ≥ k2, 1/length.
   */
  float (*principal)[2];
  /*
   Unit vector along k1; 0 at umbilics.
   */
  float (*direction)[3];
} hf_surface_points_f32;

/*
 A new mesh that is asked for.
 */
typedef struct {
  /*
   The number of vertices, at least 4; 0 for those of the old mesh, or for as many as `edge` asks for.
   */
  size_t vertices;
  /*
   The length of the edges; 0 for that which the number of vertices asks for.
   */
  double edge;
  /*
   The angle in degrees, above 0, by which triangles differ at an edge that is kept as a crease: 60 suits most.
   */
  double creases;
  /*
   Whether noise of the positions is removed first, unless it is 0.
   */
  uint32_t smooth;
} hf_remeshing;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The version of the interface that this library has: compare it with `HF_ABI_VERSION` of the header.
 */
uint32_t hf_abi_version(void);

/*
 The version of the library, such as "0.1.0". The text is static.
 */
const char *hf_version(void);

/*
 Sets `force`, `count` rows of three, to the nodal forces of the viscosity of a membrane whose vertices have
 these velocities, and `*power` to the power −Σ F·v ≥ 0 that it dissipates, unless it is NULL.

 The surface stress is (η_d − η_s) (tr d) P + 2 η_s d, d the rate of strain in the plane of a triangle and P the
 projector on it (Boussinesq and Scriven). `shear` is η_s, `dilational` η_d: force times time per length, at
 least 0, as the effect membrane_viscosity of scenes has them. Velocities of a rigid body have no force.
 */
hf_status hf_viscous_force(const hf_mesh *mesh,
                           const double (*positions)[3],
                           const double (*velocities)[3],
                           size_t count,
                           double shear,
                           double dilational,
                           double (*force)[3],
                           double *power,
                           hf_error *error);

/*
 Twin of hf_viscous_force in f32.
 */
hf_status hf_viscous_force_f32(const hf_mesh *mesh,
                               const float (*positions)[3],
                               const float (*velocities)[3],
                               size_t count,
                               float shear,
                               float dilational,
                               float (*force)[3],
                               float *power,
                               hf_error *error);

/*
 Sets `forces` to the nodal forces of a short-range repulsion of `count` surfaces from each other, and `*energy` to
 its energy, unless it is NULL.

 The energy is ½ Σ A w(d), summed over the vertices with their areas A and distances d from each other surface,
 with w(d) = k r²/4 (1 − s²)³/s², s = d/r for d < r, and 0 beyond. Fails with HF_STATUS_UNDEFINED where surfaces
 touch: it has no bound there. `modulus` is k, an energy per area squared, and `range` r. `positions` and
 `forces` have the rows of all surfaces one after the other, `total` in all; a mesh may be given several times.
 `periods` are the lengths of a periodic box along its three axes, at least the range or 0 for those that are not
 periodic, or NULL: in a box surfaces are repelled by all images, also of themselves. Evaluations run on up to
 `threads` threads, 0 for all; no result depends on their number.
 */
hf_status hf_repulsion(const hf_mesh *const *meshes,
                       size_t count,
                       const double (*positions)[3],
                       double (*forces)[3],
                       size_t total,
                       double modulus,
                       double range,
                       const double (*periods)[3],
                       double *energy,
                       size_t threads,
                       hf_error *error);

/*
 Twin of hf_repulsion in f32.
 */
hf_status hf_repulsion_f32(const hf_mesh *const *meshes,
                           size_t count,
                           const float (*positions)[3],
                           float (*forces)[3],
                           size_t total,
                           float modulus,
                           float range,
                           const float (*periods)[3],
                           float *energy,
                           size_t threads,
                           hf_error *error);

/*
 Evaluates many membranes on up to `threads` threads, 0 for all: nodal forces and energies, as by
 hf_membrane_force of each, to the last bit.

 `membranes` has `count` different membranes, which should have been made for one thread each. `positions` and
 `forces` have the rows of all membranes one after the other, `total` in all; `energies` has `count`
 numbers. If a membrane fails, the error is that of the first one, and the results of the others are valid.
 */
hf_status hf_membranes_force(hf_membrane *const *membranes,
                             size_t count,
                             const double (*positions)[3],
                             double (*forces)[3],
                             size_t total,
                             double *energies,
                             size_t threads,
                             hf_error *error);

/*
 Twin of hf_membranes_force in f32.
 */
hf_status hf_membranes_force_f32(hf_membrane *const *membranes,
                                 size_t count,
                                 const float (*positions)[3],
                                 float (*forces)[3],
                                 size_t total,
                                 float *energies,
                                 size_t threads,
                                 hf_error *error);

/*
 Measures curvatures with error bars, by jets that choose their degree and neighbours from the noise at each
 vertex, on up to `threads` threads, 0 for all.

 `positions` has `count` rows of three. `deviation` is the known standard deviation of positions along the
 normal, a length, or 0: noise is estimated in either case. Sets the arrays of `results`.
 */
hf_status hf_measure(const hf_mesh *mesh,
                     const double (*positions)[3],
                     size_t count,
                     double deviation,
                     size_t threads,
                     const hf_measured *results,
                     hf_error *error);

/*
 Twin of hf_measure in f32.
 */
hf_status hf_measure_f32(const hf_mesh *mesh,
                         const float (*positions)[3],
                         size_t count,
                         double deviation,
                         size_t threads,
                         const hf_measured_f32 *results,
                         hf_error *error);

/*
 Makes a membrane: a mesh and the effects that act on it.

 `effects` is TOML with the keys that effects have in a scene, one or more of those that hf_effect_name
 lists: `bending = { method = "j6", modulus = 1.0 }`. docs/SCENES.md describes them. Numbers have no units: they
 are in those of the caller. The `count` rows of `reference` are the positions at which effects are free of
 stress, and where initial areas and volumes are measured. `values` are `value_count` material parameters for
 `{ column = "name" }`; NULL with 0. Evaluations run on up to `threads` threads, 0 for all; no result
 depends on their number.

 On success `*membrane` is a new membrane, which hf_membrane_free frees. Fails with
 HF_STATUS_INVALID_EFFECTS if the text is wrong; the message names the line and what would be right.
 */
hf_status hf_membrane_new(const hf_mesh *mesh,
                          const double (*reference)[3],
                          size_t count,
                          const char *effects,
                          const hf_values *values,
                          size_t value_count,
                          size_t threads,
                          hf_membrane **membrane,
                          hf_error *error);

/*
 Twin of hf_membrane_new in f32.
 */
hf_status hf_membrane_new_f32(const hf_mesh *mesh,
                              const float (*reference)[3],
                              size_t count,
                              const char *effects,
                              const hf_values *values,
                              size_t value_count,
                              size_t threads,
                              hf_membrane **membrane,
                              hf_error *error);

/*
 Frees a membrane; NULL is ignored.
 */
void hf_membrane_free(hf_membrane *membrane);

/*
 Writes the warnings about the effects and the mesh, one a line, into `text`, which has room for `capacity`
 bytes; nothing if there are none. Fails with HF_STATUS_INVALID_COUNT if there is too little room, and says
 how much is needed.
 */
hf_status hf_membrane_warnings(const hf_membrane *membrane,
                               char *text,
                               size_t capacity,
                               hf_error *error);

/*
 Number of effects of a membrane that are forces, or 0 if it is NULL. Constraints are not among them.
 */
size_t hf_membrane_effect_count(const hf_membrane *membrane);

/*
 Writes the name of one of the forces of a membrane; otherwise as hf_method_name.
 */
hf_status hf_membrane_effect_name(const hf_membrane *membrane,
                                  size_t index,
                                  char *text,
                                  size_t capacity,
                                  hf_error *error);

/*
 Sets `*energy` to the sum of the energies of all effects at these positions.

 For bending by a method in strong form it is the quadrature `2κ Σ (H − H0)² A`, whose gradient is not the
 force. For bending by kantor-nelson it is `2 ∫ κ (H² − ⅔ K) dS`, 8πκ/3 for a sphere. On an open mesh the energy
 of bending leaves out about half a row of triangles at the boundary, as hf_membrane_warnings says. Fails with
 HF_STATUS_UNDEFINED if the energy is not finite.
 */
hf_status hf_membrane_energy(hf_membrane *membrane,
                             const double (*positions)[3],
                             size_t count,
                             double *energy,
                             hf_error *error);

/*
 Twin of hf_membrane_energy in f32.
 */
hf_status hf_membrane_energy_f32(hf_membrane *membrane,
                                 const float (*positions)[3],
                                 size_t count,
                                 float *energy,
                                 hf_error *error);

/*
 Sets `force`, `count` rows of three, to the nodal forces −∂E/∂x of all effects, and `*energy` to their
 energy unless it is NULL.

 Nodal forces are in units of force. Forces of bending by a method in strong form are its force density times
 the area of the vertex, without net force and torque. Quantities that are held exactly exert no force:
 see hf_membrane_constraint_gradients. Fails with HF_STATUS_UNDEFINED if a force is not finite.
 */
hf_status hf_membrane_force(hf_membrane *membrane,
                            const double (*positions)[3],
                            size_t count,
                            double (*force)[3],
                            double *energy,
                            hf_error *error);

/*
 Twin of hf_membrane_force in f32.
 */
hf_status hf_membrane_force_f32(hf_membrane *membrane,
                                const float (*positions)[3],
                                size_t count,
                                float (*force)[3],
                                float *energy,
                                hf_error *error);

/*
 Sets `energies` to the energy of each effect, and `forces` to its nodal forces: `effect_count` numbers, and
 `effect_count` times `count` rows of three. Either may be NULL.

 The order is that of hf_membrane_effect_name.
 */
hf_status hf_membrane_effect_forces(hf_membrane *membrane,
                                    const double (*positions)[3],
                                    size_t count,
                                    double *energies,
                                    double (*forces)[3],
                                    size_t effect_count,
                                    hf_error *error);

/*
 Twin of hf_membrane_effect_forces in f32.
 */
hf_status hf_membrane_effect_forces_f32(hf_membrane *membrane,
                                        const float (*positions)[3],
                                        size_t count,
                                        float *energies,
                                        float (*forces)[3],
                                        size_t effect_count,
                                        hf_error *error);

/*
 Number of quantities of a membrane that are held exactly, or 0 if it is NULL.
 */
size_t hf_membrane_constraint_count(const hf_membrane *membrane);

/*
 Sets `gradients`, `constraint_count` times `count` rows of three, to the gradients of the quantities that are
 held exactly, one quantity after the other. Forces without their components along these keep the quantities.
 */
hf_status hf_membrane_constraint_gradients(hf_membrane *membrane,
                                           const double (*positions)[3],
                                           size_t count,
                                           double (*gradients)[3],
                                           size_t constraint_count,
                                           hf_error *error);

/*
 Moves `positions` so that each quantity that is held exactly has its target value, and sets `*residual` to
 the largest relative error that remains; it is infinite if the targets cannot be reached from there.
 */
hf_status hf_membrane_restore(hf_membrane *membrane,
                              double (*positions)[3],
                              size_t count,
                              double *residual,
                              hf_error *error);

/*
 Adds the nodal forces of a membrane whose vertices are scattered in larger arrays of an engine.

 The position of vertex i is row `places[i]` of `positions`, which has `total` rows; `places` has `count`
 entries, one for each vertex. Forces are added to the `owned` first rows of `force`, and left out at places
 beyond, those of ghosts: where several ranks have all vertices of a membrane as owned or ghost ones, each
 evaluates it and keeps its own share, and no forces are sent. Ghosts have to be unwrapped images, near
 their neighbours. `*energy` is set to the energy of the whole membrane unless it is NULL.
 */
hf_status hf_membrane_add_force_at(hf_membrane *membrane,
                                   const uint32_t *places,
                                   size_t count,
                                   const double (*positions)[3],
                                   size_t total,
                                   size_t owned,
                                   double (*force)[3],
                                   double *energy,
                                   hf_error *error);

/*
 Twin of hf_membrane_add_force_at in f32.
 */
hf_status hf_membrane_add_force_at_f32(hf_membrane *membrane,
                                       const uint32_t *places,
                                       size_t count,
                                       const float (*positions)[3],
                                       size_t total,
                                       size_t owned,
                                       float (*force)[3],
                                       float *energy,
                                       hf_error *error);

/*
 Makes a mesh of triangles whose corners run counter-clockwise seen from outside.

 `triangles` has `triangle_count` rows of three numbers of vertices, each below `vertex_count`. On success
 `*mesh` is a new mesh, which hf_mesh_free frees. Fails with HF_STATUS_INVALID_MESH if the triangles are no
 oriented manifold.
 */
hf_status hf_mesh_new(size_t vertex_count,
                      const uint32_t (*triangles)[3],
                      size_t triangle_count,
                      hf_mesh **mesh,
                      hf_error *error);

/*
 Reads a mesh with its positions from an OBJ, OFF, STL, PLY, VTP, VTU, VTK, glTF, MSH, GIFTI or 3MF file.

 `path` is UTF-8. Vertices at the same point are merged if `weld` is not 0. On success `*mesh` is a new mesh,
 which hf_mesh_free frees. Fails with HF_STATUS_UNREADABLE_FILE if there is no such file or no mesh in it.
 */
hf_status hf_mesh_read(const char *path,
                       uint32_t weld,
                       hf_mesh **mesh,
                       hf_error *error);

/*
 Frees a mesh; NULL is ignored. Membranes and methods that were made with it stay usable.
 */
void hf_mesh_free(hf_mesh *mesh);

/*
 Number of vertices, or 0 if `mesh` is NULL.
 */
size_t hf_mesh_vertex_count(const hf_mesh *mesh);

/*
 Number of triangles, or 0 if `mesh` is NULL.
 */
size_t hf_mesh_triangle_count(const hf_mesh *mesh);

/*
 Sets `triangles` to the corners of the triangles, `triangle_count` rows of three.
 */
hf_status hf_mesh_triangles(const hf_mesh *mesh,
                            uint32_t (*triangles)[3],
                            size_t triangle_count,
                            hf_error *error);

/*
 Sets `positions`, `count` rows of three, to the positions in the mesh's file, in its unit of length, or to those
 of a mesh that hf_remesh made.

 Fails with HF_STATUS_UNDEFINED for meshes of triangles alone.
 */
hf_status hf_mesh_positions(const hf_mesh *mesh,
                            double (*positions)[3],
                            size_t count,
                            hf_error *error);

/*
 Twin of hf_mesh_positions in f32.
 */
hf_status hf_mesh_positions_f32(const hf_mesh *mesh,
                                float (*positions)[3],
                                size_t count,
                                hf_error *error);

/*
 Sets `*area` to the area of a surface, length².
 */
hf_status hf_area(const hf_mesh *mesh,
                  const double (*positions)[3],
                  size_t count,
                  double *area,
                  hf_error *error);

/*
 Twin of hf_area in f32.
 */
hf_status hf_area_f32(const hf_mesh *mesh,
                      const float (*positions)[3],
                      size_t count,
                      float *area,
                      hf_error *error);

/*
 Sets `*volume` to the enclosed volume, length³: positive if triangles run counter-clockwise seen from
 outside. Fails with HF_STATUS_UNDEFINED for open surfaces.
 */
hf_status hf_volume(const hf_mesh *mesh,
                    const double (*positions)[3],
                    size_t count,
                    double *volume,
                    hf_error *error);

/*
 Twin of hf_volume in f32.
 */
hf_status hf_volume_f32(const hf_mesh *mesh,
                        const float (*positions)[3],
                        size_t count,
                        float *volume,
                        hf_error *error);

/*
 Prepares a method for a mesh.

 `name` is one of those that hf_method_name lists. `areas` are "mixed", "voronoi" or "barycentric", for
 gompper-kroll and meyer; `bandwidth` is a number of mean vertex areas, "converging" or "published", for
 belkin; NULL is the default of either. `modulus` is the bending modulus κ, an energy above 0, of which
 kantor-nelson makes the modulus k̃ = 2κ/√3 of an edge: its forces are those of κ. `spontaneous_curvature` is H0,
 1/length, positive on a sphere. Evaluations run on up to `threads` threads, 0 for all; no result depends on their
 number. On success `*method` is a new method, which hf_method_free frees.
 */
hf_status hf_method_new(const hf_mesh *mesh,
                        const char *name,
                        const char *areas,
                        const char *bandwidth,
                        double modulus,
                        double spontaneous_curvature,
                        size_t threads,
                        hf_method **method,
                        hf_error *error);

/*
 Frees a method; NULL is ignored.
 */
void hf_method_free(hf_method *method);

/*
 Evaluates a method at positions, `count` rows of three, and sets the arrays of `fields`.
 */
hf_status hf_method_fields(hf_method *method,
                           const double (*positions)[3],
                           size_t count,
                           const hf_fields *fields,
                           hf_error *error);

/*
 Twin of hf_method_fields in f32.
 */
hf_status hf_method_fields_f32(hf_method *method,
                               const float (*positions)[3],
                               size_t count,
                               const hf_fields_f32 *fields,
                               hf_error *error);

/*
 Writes the name of a method into `text`, which has room for `capacity` bytes: 64 suffice.

 `index` counts from 0. Fails with HF_STATUS_INVALID_ARGUMENT beyond the last, and with
 HF_STATUS_INVALID_COUNT if there is too little room.
 */
hf_status hf_method_name(size_t index, char *text, size_t capacity, hf_error *error);

/*
 Writes the name of an effect, which is its key in the text of hf_membrane_new; otherwise as hf_method_name.
 */
hf_status hf_effect_name(size_t index,
                         char *text,
                         size_t capacity,
                         hf_error *error);

/*
 Writes the name of a kind of finding, which is the bit `index` of a vertex's flags; otherwise as
 hf_method_name.
 */
hf_status hf_flag_name(size_t index, char *text, size_t capacity, hf_error *error);

/*
 Writes the name of a verdict of hf_measure; otherwise as hf_method_name.
 */
hf_status hf_verdict_name(size_t index, char *text, size_t capacity, hf_error *error);

/*
 Number of entries of the matrices of a mesh: one for each vertex, and two for each edge; 0 if it is NULL.
 */
size_t hf_mesh_entry_count(const hf_mesh *mesh);

/*
 Sets a matrix to the stiffness S_ij = ∫ ∇λ_i·∇λ_j dS of linear finite elements: symmetric, positive
 semi-definite, dimensionless. −Δ_S φ is S φ divided by the areas of hf_vertex_areas.

 The matrix is in compressed rows: row i has the entries `offsets[i]` to `offsets[i + 1]`, excluded, of
 `columns` and `values`, columns in increasing order. `offsets` has a number for each of `count` vertices and one
 more; `columns` and `values` have `entries` numbers, as many as hf_mesh_entry_count says. The pattern depends
 on the mesh alone.
 */
hf_status hf_stiffness(const hf_mesh *mesh,
                       const double (*positions)[3],
                       size_t count,
                       size_t *offsets,
                       size_t *columns,
                       double *values,
                       size_t entries,
                       hf_error *error);

/*
 Twin of hf_stiffness in f32.
 */
hf_status hf_stiffness_f32(const hf_mesh *mesh,
                           const float (*positions)[3],
                           size_t count,
                           size_t *offsets,
                           size_t *columns,
                           float *values,
                           size_t entries,
                           hf_error *error);

/*
 Sets a matrix to the consistent mass M_ij = ∫ λ_i λ_j dS, length², with the pattern of hf_stiffness:
 positive definite, and all entries together are the area.
 */
hf_status hf_mass(const hf_mesh *mesh,
                  const double (*positions)[3],
                  size_t count,
                  size_t *offsets,
                  size_t *columns,
                  double *values,
                  size_t entries,
                  hf_error *error);

/*
 Twin of hf_mass in f32.
 */
hf_status hf_mass_f32(const hf_mesh *mesh,
                      const float (*positions)[3],
                      size_t count,
                      size_t *offsets,
                      size_t *columns,
                      float *values,
                      size_t entries,
                      hf_error *error);

/*
 Sets `areas` to the areas of the vertices, length², the diagonal of the lumped mass matrix.

 `kind` is "mixed", "voronoi" or "barycentric".
 */
hf_status hf_vertex_areas(const hf_mesh *mesh,
                          const double (*positions)[3],
                          size_t count,
                          const char *kind,
                          double *areas,
                          hf_error *error);

/*
 Twin of hf_vertex_areas in f32.
 */
hf_status hf_vertex_areas_f32(const hf_mesh *mesh,
                              const float (*positions)[3],
                              size_t count,
                              const char *kind,
                              float *areas,
                              hf_error *error);

/*
 Sets `gradient`, `triangle_count` rows of three, to the surface gradient of a field with a number for each of
 `count` vertices: one tangential vector for each triangle, in the unit of the field divided by length.
 */
hf_status hf_gradient(const hf_mesh *mesh,
                      const double (*positions)[3],
                      size_t count,
                      const double *field,
                      double (*gradient)[3],
                      size_t triangle_count,
                      hf_error *error);

/*
 Twin of hf_gradient in f32.
 */
hf_status hf_gradient_f32(const hf_mesh *mesh,
                          const float (*positions)[3],
                          size_t count,
                          const float *field,
                          float (*gradient)[3],
                          size_t triangle_count,
                          hf_error *error);

/*
 Fits the smooth surface through the vertices of a mesh, by polynomials of this degree, 4, 6, 8, or 0 for that
 which suits the mesh, on up to `threads` threads, 0 for all.

 `positions` has `count` rows of three, which are taken as exact. On success `*surface` is a new surface, which
 hf_surface_free frees. Positions have errors of order degree + 1 in the edge length, H and K of order degree − 1.
 */
hf_status hf_surface_new(const hf_mesh *mesh,
                         const double (*positions)[3],
                         size_t count,
                         uint32_t degree,
                         size_t threads,
                         hf_surface **surface,
                         hf_error *error);

/*
 Twin of hf_surface_new in f32.
 */
hf_status hf_surface_new_f32(const hf_mesh *mesh,
                             const float (*positions)[3],
                             size_t count,
                             uint32_t degree,
                             size_t threads,
                             hf_surface **surface,
                             hf_error *error);

/*
 Frees a surface; NULL is ignored.
 */
void hf_surface_free(hf_surface *surface);

/*
 Points of a smooth surface over places of its mesh, on up to `threads` threads, 0 for all.

 `faces` has `count` numbers of triangles, `weights` `count` rows with the weights of their corners, at least 0
 with the sum 1. Sets the arrays of `results`.
 */
hf_status hf_surface_at(const hf_surface *surface,
                        const uint32_t *faces,
                        const double (*weights)[3],
                        size_t count,
                        size_t threads,
                        const hf_surface_points *results,
                        hf_error *error);

/*
 Twin of hf_surface_at in f32.
 */
hf_status hf_surface_at_f32(const hf_surface *surface,
                            const uint32_t *faces,
                            const float (*weights)[3],
                            size_t count,
                            size_t threads,
                            const hf_surface_points_f32 *results,
                            hf_error *error);

/*
 The places of the mesh over which a smooth surface is nearest to points, `count` rows of three, on up to
 `threads` threads, 0 for all: sets `faces`, `count` triangles, and `weights`, `count` rows with the weights of
 their corners.
 */
hf_status hf_surface_project(const hf_surface *surface,
                             const double (*points)[3],
                             size_t count,
                             size_t threads,
                             uint32_t *faces,
                             double (*weights)[3],
                             hf_error *error);

/*
 Twin of hf_surface_project in f32.
 */
hf_status hf_surface_project_f32(const hf_surface *surface,
                                 const float (*points)[3],
                                 size_t count,
                                 size_t threads,
                                 uint32_t *faces,
                                 float (*weights)[3],
                                 hf_error *error);

/*
 The values of a field at places of the mesh, as smooth as the surface, on up to `threads` threads, 0 for all.

 `field` has `vertex_count` numbers, one for each vertex; `faces` and `weights` are as for hf_surface_at. Sets
 `values`, and the error bars `errors` unless it is NULL: infinite where values are interpolated linearly for want
 of a fit.
 */
hf_status hf_surface_interpolate(const hf_surface *surface,
                                 const double *field,
                                 size_t vertex_count,
                                 const uint32_t *faces,
                                 const double (*weights)[3],
                                 size_t count,
                                 size_t threads,
                                 double *values,
                                 double *errors,
                                 hf_error *error);

/*
 Twin of hf_surface_interpolate in f32.
 */
hf_status hf_surface_interpolate_f32(const hf_surface *surface,
                                     const float *field,
                                     size_t vertex_count,
                                     const uint32_t *faces,
                                     const float (*weights)[3],
                                     size_t count,
                                     size_t threads,
                                     float *values,
                                     float *errors,
                                     hf_error *error);

/*
 Makes a mesh with even triangles of the smooth surface through the vertices, on up to `threads` threads, 0 for
 all. Borders and creases keep their curves.

 `positions` has `count` rows of three. On success `*made` is a new mesh, which hf_mesh_free frees, and
 hf_mesh_positions has its positions. Places of its vertices on the old mesh, where fields can be interpolated, are
 found by hf_surface_project. Fails with HF_STATUS_UNDEFINED if positions are noisy, or triangles would cross.
 */
hf_status hf_remesh(const hf_mesh *mesh,
                    const double (*positions)[3],
                    size_t count,
                    const hf_remeshing *remeshing,
                    size_t threads,
                    hf_mesh **made,
                    hf_error *error);

/*
 Twin of hf_remesh in f32.
 */
hf_status hf_remesh_f32(const hf_mesh *mesh,
                        const float (*positions)[3],
                        size_t count,
                        const hf_remeshing *remeshing,
                        size_t threads,
                        hf_mesh **made,
                        hf_error *error);

/*
 The meaning of a status in a few words. The text is static; for numbers without meaning it is "unknown
 status".
 */
const char *hf_status_text(int status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* HELFRICH_H */
