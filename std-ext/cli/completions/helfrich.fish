# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_helfrich_global_optspecs
    string join \n h/help V/version
end

function __fish_helfrich_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_helfrich_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_helfrich_using_subcommand
    set -l cmd (__fish_helfrich_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c helfrich -n "__fish_helfrich_needs_command" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_needs_command" -s V -l version -d 'Print version'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "study" -d 'Measure errors and times of bending methods on exact shapes'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "recommend" -d 'Recommend a method for a mesh file, by measurements on that mesh'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "curvature" -d 'Compute curvatures and force density at every vertex of a mesh file, as CSV or VTP'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "info" -d 'Show counts, topology, area, volume and quality of a mesh file'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "remesh" -d 'Make a new mesh with even triangles of the smooth surface through the vertices of a mesh file'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "repair" -d 'Make a mesh of a file that others refuse, and say what was changed'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "smooth" -d 'Remove the noise of the positions of a mesh file, or smooth them by mean-curvature flow'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "split" -d 'Write each connected component of a mesh file to a file of its own'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "subdivide" -d 'Refine a mesh file by Loop\'s rules: four triangles for each triangle and level'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "run" -d 'Run a scene: surfaces, the effects that act on each, and a driver that moves them'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "sweep" -d 'Run a scene with every combination of given values, and compare the results'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "scenes" -d 'List the scenes that come with the program, which `run`, `sweep` and `explain` take by name'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "paper" -d 'Make the figures of Guckenberger et al. (2016) with ours beside its data, as one page'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "explain" -d 'Explain a scene without running it: effects, dimensionless groups, memory, step limits'
complete -c helfrich -n "__fish_helfrich_needs_command" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l shape -d 'Exact shape: sphere[:R], ellipsoid[:a,b,c], torus[:R,r] or discocyte[:R]' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l method -d 'Methods by name or letter, or `all`: kantor-nelson (A), gompper-kroll (B), meyer (C), belkin (D), farutin (E), loop (S), juelicher, hamann, galerkin (G), j4, j6, j8, jet (J), corrected, corrected-fit; jet is j4, j6 or j8, by the number of vertices. By default A,B,C,J6' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l areas -d 'Vertex areas of gompper-kroll and meyer: mixed, voronoi or barycentric; by default mixed' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l bandwidth -d 'Bandwidth of the heat kernel of belkin: a number of mean vertex areas; `converging`, the default, which is max(1/4, sqrt(N)/100) of them; or `published`, the mixed area of each vertex' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l family -d 'Mesh families: regular, smooth, relaxed, irregular, hard, or `all`' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l vertices -d 'Numbers of vertices, 12 or more, in any order. Meshes with 10·4^k + 2 vertices are the most regular; meshes of the torus have these numbers within 1 %. By default 642,2562,10242,40962' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l scalar -d 'Number types: f32, f32-pair (positions as pairs of f32), f64. By default f64; with `--html` f32,f64' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l modulus -d 'Bending modulus κ' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l seed -d 'Seed of the random mesh families' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l html -d 'Write a page to this file that names the cheapest method for each accuracy, with figures, tables and pictures; by default of all methods' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l figures -d 'Also write every figure of the page as SVG and PNG to this folder' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l json -d 'Also write the rows as JSON to this file; `-` writes them to standard output instead of the table' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l csv -d 'Also write the rows as CSV to this file; `-` writes them to standard output instead of the table' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l noise -d 'Compare methods, `jet` and the best fixed fit on noisy vertices instead. The values are standard deviations of every coordinate in mean edge lengths, from 0 to 1; by default with 2562 vertices and all methods. With `--html` this comparison is added to the page' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l cache -d 'File in which measurements are kept, so that a repeated or interrupted study reuses them; by default, for pages only, in the user\'s cache folder' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -l fresh -d 'Measure everything again'
complete -c helfrich -n "__fish_helfrich_using_subcommand study" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l error -d 'Largest allowed error, as in `1%` or `0.01`, relative to the largest value on the surface' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l quantity -d 'Quantity that has to be accurate: H, K, LapH or f' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l norm -d 'Norm of the error: `max`, at every vertex, or `mean`, on average' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l method -d 'Methods to choose from, by name or letter; by default all' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l areas -d 'Vertex areas of gompper-kroll and meyer: mixed, voronoi or barycentric; by default mixed' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l bandwidth -d 'Bandwidth of the heat kernel of belkin: a number of mean vertex areas; `converging`, the default, which is max(1/4, sqrt(N)/100) of them; or `published`, the mixed area of each vertex' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l scalar -d 'Number types to choose from: f32, f32-pair, f64' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l json -d 'Also write the answer as JSON to this file; `-` writes it to standard output instead of the table' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand recommend" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l method -d 'Method by name or letter: kantor-nelson (A), gompper-kroll (B), meyer (C), belkin (D), farutin (E), loop (S), juelicher, hamann, galerkin (G), j4, j6, j8, jet (J), corrected, corrected-fit; jet chooses degree and neighbours from the noise at each vertex' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l modulus -d 'Bending modulus κ' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l areas -d 'Vertex areas of gompper-kroll and meyer: mixed, voronoi or barycentric; by default mixed' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l bandwidth -d 'Bandwidth of the heat kernel of belkin: a number of mean vertex areas; `converging`, the default, which is max(1/4, sqrt(N)/100) of them; or `published`, the mixed area of each vertex' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l scalar -d 'Number type: f32, f32-pair (positions as pairs of f32) or f64' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l sigma -d 'Known standard deviation of the positions along the normal, a length: a lower bound of the noise that is assumed. By default the noise is estimated from the positions' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l scale -d 'Number of neighbours of the fits of `jet`, 28 to 4096. By default it is chosen from the noise, at each vertex and separately for H, K and f' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l radius -d 'Radius of the fits of `jet` instead, a length: they take all vertices within it, 28 to 4096 of them' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l csv -d 'Write to this file instead of standard output (`-`)' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l vtp -d 'Write the surface with all results to this `.vtp` file; a table is then written only with `--csv`' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l picture -d 'Draw the surface to this `.png` file, with principal directions if `--method jet` or `--errors` is given; a table is then written only with `--csv`. The surface is grey where twice the error bar exceeds the range of the colours' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l colour-by -d 'Quantity that the picture shows, by the name of its column; f is shown along the normal. Quantities other than H, K and f need `--method jet` or `--errors`' -r -f -a "H\t''
K\t''
f\t''
k1\t''
k2\t''
curvedness\t''
shape_index\t''
H_error\t''
K_error\t''
f_error\t''
k1_error\t''
k2_error\t''
curvedness_error\t''
shape_index_error\t''
sigma\t''"
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -l errors -d 'Add principal curvatures, error bars and a verdict to the results of any method, by comparison with jets that choose their scale from the noise; `--method jet` always has them'
complete -c helfrich -n "__fish_helfrich_using_subcommand curvature" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_using_subcommand info" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand info" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l vertices -d 'Number of vertices; by default that of the input, unless lengths are given' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l edge -d 'Length of the edges, in the unit of the file' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l field -d 'Lengths of the edges from the numbers at the vertices with this name, in a PLY, VTK or GIFTI file; with `--vertices`, relative to each other' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l curvature -d 'Lengths by curvature: no edge turns by more than this angle, in degrees; with `--vertices`, relative to each other' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l error -d 'Edges as long as the error of H may be at most this part of the largest |H|, as in `1%` or `0.01`' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l creases -d 'Keep edges as creases at which the triangles differ by more than this angle, in degrees' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -s o -l output -d 'Output file; its ending determines the format. Numbers at vertices and triangles are kept in `.vtp`' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -l smooth -d 'Remove the noise of the positions first'
complete -c helfrich -n "__fish_helfrich_using_subcommand remesh" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l sheets -d 'Sheets to keep at edges with three or more triangles: `split` keeps all, `largest` the one with the largest area' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l fill -d 'Fill holes with at most this number of edges. Borders that span more than half of the area of their component are outlines, and stay' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l slivers -d 'Remove triangles with an angle below this one, in degrees, by flips and collapses of edges' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -s o -l output -d 'Output file; its ending determines the format: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and faces are kept in .vtp' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l outward -d 'Turn closed components that are inside out, even if they are valid'
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -l drop-unused -d 'Leave out vertices in no triangle of the file, too'
complete -c helfrich -n "__fish_helfrich_using_subcommand repair" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -l scale -d 'Number of neighbours of the fits, 28 to 4096, whatever the noise is: more of them smooth more. The fits have degree 4. By default number and degree are chosen from the noise' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -l flow -d 'Smooth by one implicit step of mean-curvature flow instead, of this time: a length squared, in the unit of the file. Waves of length L are multiplied by 1/(1 + 39.5 TIME/L²)' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -s o -l output -d 'Output file; its ending determines the format: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and triangles are kept in .vtp' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand smooth" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_using_subcommand split" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand split" -l least -d 'Leave out components with fewer vertices, such as specks of a segmentation' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand split" -l format -d 'Format of the files: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and triangles are kept in .vtp' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand split" -s o -l out -d 'Folder for the files component-1, component-2 and so on, in the order of their first vertices' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand split" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand subdivide" -l weld -d 'Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand subdivide" -l levels -d 'Number of refinements' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand subdivide" -s o -l output -d 'Output file; its ending determines the format: .obj, .off, .stl, .ply, .vtp and .glb' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand subdivide" -l limit -d 'Place the vertices on the smooth surface to which further refinement would converge'
complete -c helfrich -n "__fish_helfrich_using_subcommand subdivide" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -l set -d 'Replace a value of the scene, as in `surface.vesicle.bending.modulus=0.3`, or remove it, as in `surface.vesicle.bending=`; may be repeated' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -l out -d 'Output folder; by default the scene\'s name without `.toml`' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -l resume -d 'Continue the run in the folder from its last checkpoint'
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -l check -d 'Only report problems of the scene'
complete -c helfrich -n "__fish_helfrich_using_subcommand run" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l set -d 'Replace a value of the scene, as in `surface.vesicle.bending.modulus=0.3`, or remove it, as in `surface.vesicle.bending=`; may be repeated' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l out -d 'Output folder, with a subfolder for each run' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l vary -d 'A key and its values, as in `surface.0.bending.method=meyer,juelicher`; may be repeated, and the last key varies fastest. Commas inside brackets, braces and quotation marks belong to a value' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l columns -d 'Columns of the series to show and to plot; by default those of the scene\'s plots' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l part -d 'Run only the Kth of N parts: every Nth combination from the Kth on. Other processes, also on other machines, may run other parts in the same folder at the same time; the same command with `--resume` and without this compares all runs' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l jobs -d 'Number of simultaneous runs, from 1 to 1024, which share the threads equally. As many jobs as threads suit runs with small meshes' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -l resume -d 'Continue the runs in the folder; runs that have ended are skipped'
complete -c helfrich -n "__fish_helfrich_using_subcommand sweep" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand scenes" -l out -d 'Write the scenes to this folder, with the files that they need and their JSON schema. Existing files are not overwritten' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand scenes" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -s o -l out -d 'Output folder: the page `index.html`, and the runs of scenes in `runs`' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l part -d 'Parts of the page; by default all' -r -f -a "curvature\t'Curvatures and forces on the exact red blood cell, over refinement and families of meshes'
capsule\t'The capsule in shear flow by both solvers, and what others found'
precision\t'f32 beside f64: errors and times in every number type'"
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l method -d 'Methods by name or letter; by default A,B,C,D,E,S,G,J6. On the lattice those of B, C, S and J6 among them' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l vertices -d 'Numbers of vertices of the red blood cell. By default 642,2562,10242,40962; with `--quick` 162,642,2562' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l figures -d 'Also write every figure of the page as SVG and PNG to this folder' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l cache -d 'File in which measurements are kept, so that a repeated or interrupted study reuses them; by default, for pages only, in the user\'s cache folder' -r -F
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l quick -d 'Take coarser meshes and shorter runs: less than a minute instead of ten'
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -l fresh -d 'Measure everything again'
complete -c helfrich -n "__fish_helfrich_using_subcommand paper" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c helfrich -n "__fish_helfrich_using_subcommand explain" -l set -d 'Replace a value of the scene, as in `surface.vesicle.bending.modulus=0.3`, or remove it, as in `surface.vesicle.bending=`; may be repeated' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand explain" -l threads -d 'Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it' -r
complete -c helfrich -n "__fish_helfrich_using_subcommand explain" -s h -l help -d 'Print help'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "study" -d 'Measure errors and times of bending methods on exact shapes'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "recommend" -d 'Recommend a method for a mesh file, by measurements on that mesh'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "curvature" -d 'Compute curvatures and force density at every vertex of a mesh file, as CSV or VTP'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "info" -d 'Show counts, topology, area, volume and quality of a mesh file'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "remesh" -d 'Make a new mesh with even triangles of the smooth surface through the vertices of a mesh file'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "repair" -d 'Make a mesh of a file that others refuse, and say what was changed'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "smooth" -d 'Remove the noise of the positions of a mesh file, or smooth them by mean-curvature flow'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "split" -d 'Write each connected component of a mesh file to a file of its own'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "subdivide" -d 'Refine a mesh file by Loop\'s rules: four triangles for each triangle and level'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "run" -d 'Run a scene: surfaces, the effects that act on each, and a driver that moves them'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "sweep" -d 'Run a scene with every combination of given values, and compare the results'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "scenes" -d 'List the scenes that come with the program, which `run`, `sweep` and `explain` take by name'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "paper" -d 'Make the figures of Guckenberger et al. (2016) with ours beside its data, as one page'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "explain" -d 'Explain a scene without running it: effects, dimensionless groups, memory, step limits'
complete -c helfrich -n "__fish_helfrich_using_subcommand help; and not __fish_seen_subcommand_from study recommend curvature info remesh repair smooth split subdivide run sweep scenes paper explain help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
