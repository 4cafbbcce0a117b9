#compdef helfrich

autoload -U is-at-least

_helfrich() {
    typeset -A opt_args
    typeset -a _arguments_options
    local ret=1

    if is-at-least 5.2; then
        _arguments_options=(-s -S -C)
    else
        _arguments_options=(-s -C)
    fi

    local context curcontext="$curcontext" state line
    _arguments "${_arguments_options[@]}" : \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
'-V[Print version]' \
'--version[Print version]' \
":: :_helfrich_commands" \
"*::: :->helfrich" \
&& ret=0
    case $state in
    (helfrich)
        words=($line[1] "${words[@]}")
        (( CURRENT += 1 ))
        curcontext="${curcontext%:*:*}:helfrich-command-$line[1]:"
        case $line[1] in
            (study)
_arguments "${_arguments_options[@]}" : \
'--shape=[Exact shape\: sphere\[\:R\], ellipsoid\[\:a,b,c\], torus\[\:R,r\] or discocyte\[\:R\]]:SHAPE:_default' \
'*--method=[Methods by name or letter, or \`all\`\: kantor-nelson (A), gompper-kroll (B), meyer (C), belkin (D), farutin (E), loop (S), juelicher, hamann, galerkin (G), j4, j6, j8, jet (J), corrected, corrected-fit; jet is j4, j6 or j8, by the number of vertices. By default A,B,C,J6]:METHOD:_default' \
'--areas=[Vertex areas of gompper-kroll and meyer\: mixed, voronoi or barycentric; by default mixed]:AREAS:_default' \
'--bandwidth=[Bandwidth of the heat kernel of belkin\: a number of mean vertex areas; \`converging\`, the default, which is max(1/4, sqrt(N)/100) of them; or \`published\`, the mixed area of each vertex]:BANDWIDTH:_default' \
'*--family=[Mesh families\: regular, smooth, relaxed, irregular, hard, or \`all\`]:FAMILY:_default' \
'*--vertices=[Numbers of vertices, 12 or more, in any order. Meshes with 10·4^k + 2 vertices are the most regular; meshes of the torus have these numbers within 1 %. By default 642,2562,10242,40962]:VERTICES:_default' \
'*--scalar=[Number types\: f32, f32-pair (positions as pairs of f32), f64. By default f64; with \`--html\` f32,f64]:SCALAR:_default' \
'--modulus=[Bending modulus κ]:MODULUS:_default' \
'--seed=[Seed of the random mesh families]:SEED:_default' \
'--html=[Write a page to this file that names the cheapest method for each accuracy, with figures, tables and pictures; by default of all methods]:FILE:_files' \
'--figures=[Also write every figure of the page as SVG and PNG to this folder]:FOLDER:_files' \
'--json=[Also write the rows as JSON to this file; \`-\` writes them to standard output instead of the table]:JSON:_files' \
'--csv=[Also write the rows as CSV to this file; \`-\` writes them to standard output instead of the table]:CSV:_files' \
'*--noise=[Compare methods, \`jet\` and the best fixed fit on noisy vertices instead. The values are standard deviations of every coordinate in mean edge lengths, from 0 to 1; by default with 2562 vertices and all methods. With \`--html\` this comparison is added to the page]::EDGES:_default' \
'--cache=[File in which measurements are kept, so that a repeated or interrupted study reuses them; by default, for pages only, in the user'\''s cache folder]:FILE:_files' \
'--fresh[Measure everything again]' \
'-h[Print help]' \
'--help[Print help]' \
&& ret=0
;;
(recommend)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--error=[Largest allowed error, as in \`1%\` or \`0.01\`, relative to the largest value on the surface]:ERROR:_default' \
'--quantity=[Quantity that has to be accurate\: H, K, LapH or f]:QUANTITY:_default' \
'--norm=[Norm of the error\: \`max\`, at every vertex, or \`mean\`, on average]:NORM:_default' \
'*--method=[Methods to choose from, by name or letter; by default all]:METHOD:_default' \
'--areas=[Vertex areas of gompper-kroll and meyer\: mixed, voronoi or barycentric; by default mixed]:AREAS:_default' \
'--bandwidth=[Bandwidth of the heat kernel of belkin\: a number of mean vertex areas; \`converging\`, the default, which is max(1/4, sqrt(N)/100) of them; or \`published\`, the mixed area of each vertex]:BANDWIDTH:_default' \
'*--scalar=[Number types to choose from\: f32, f32-pair, f64]:SCALAR:_default' \
'--json=[Also write the answer as JSON to this file; \`-\` writes it to standard output instead of the table]:JSON:_files' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'-h[Print help]' \
'--help[Print help]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(curvature)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--method=[Method by name or letter\: kantor-nelson (A), gompper-kroll (B), meyer (C), belkin (D), farutin (E), loop (S), juelicher, hamann, galerkin (G), j4, j6, j8, jet (J), corrected, corrected-fit; jet chooses degree and neighbours from the noise at each vertex]:METHOD:_default' \
'--modulus=[Bending modulus κ]:MODULUS:_default' \
'--areas=[Vertex areas of gompper-kroll and meyer\: mixed, voronoi or barycentric; by default mixed]:AREAS:_default' \
'--bandwidth=[Bandwidth of the heat kernel of belkin\: a number of mean vertex areas; \`converging\`, the default, which is max(1/4, sqrt(N)/100) of them; or \`published\`, the mixed area of each vertex]:BANDWIDTH:_default' \
'--scalar=[Number type\: f32, f32-pair (positions as pairs of f32) or f64]:SCALAR:_default' \
'--sigma=[Known standard deviation of the positions along the normal, a length\: a lower bound of the noise that is assumed. By default the noise is estimated from the positions]:LENGTH:_default' \
'--scale=[Number of neighbours of the fits of \`jet\`, 28 to 4096. By default it is chosen from the noise, at each vertex and separately for H, K and f]:NEIGHBOURS:_default' \
'(--scale)--radius=[Radius of the fits of \`jet\` instead, a length\: they take all vertices within it, 28 to 4096 of them]:LENGTH:_default' \
'--csv=[Write to this file instead of standard output (\`-\`)]:CSV:_files' \
'--vtp=[Write the surface with all results to this \`.vtp\` file; a table is then written only with \`--csv\`]:FILE:_files' \
'--picture=[Draw the surface to this \`.png\` file, with principal directions if \`--method jet\` or \`--errors\` is given; a table is then written only with \`--csv\`. The surface is grey where twice the error bar exceeds the range of the colours]:FILE:_files' \
'--colour-by=[Quantity that the picture shows, by the name of its column; f is shown along the normal. Quantities other than H, K and f need \`--method jet\` or \`--errors\`]:QUANTITY:(H K f k1 k2 curvedness shape_index H_error K_error f_error k1_error k2_error curvedness_error shape_index_error sigma)' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'--errors[Add principal curvatures, error bars and a verdict to the results of any method, by comparison with jets that choose their scale from the noise; \`--method jet\` always has them]' \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(info)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'-h[Print help]' \
'--help[Print help]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(remesh)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--vertices=[Number of vertices; by default that of the input, unless lengths are given]:NUMBER:_default' \
'(--vertices)--edge=[Length of the edges, in the unit of the file]:LENGTH:_default' \
'(--edge)--field=[Lengths of the edges from the numbers at the vertices with this name, in a PLY, VTK or GIFTI file; with \`--vertices\`, relative to each other]:COLUMN:_default' \
'(--edge --field)--curvature=[Lengths by curvature\: no edge turns by more than this angle, in degrees; with \`--vertices\`, relative to each other]:DEGREES:_default' \
'(--edge --field --curvature --vertices)--error=[Edges as long as the error of H may be at most this part of the largest |H|, as in \`1%\` or \`0.01\`]:PART:_default' \
'--creases=[Keep edges as creases at which the triangles differ by more than this angle, in degrees]:DEGREES:_default' \
'-o+[Output file; its ending determines the format. Numbers at vertices and triangles are kept in \`.vtp\`]:OUTPUT:_files' \
'--output=[Output file; its ending determines the format. Numbers at vertices and triangles are kept in \`.vtp\`]:OUTPUT:_files' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'--smooth[Remove the noise of the positions first]' \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(repair)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--sheets=[Sheets to keep at edges with three or more triangles\: \`split\` keeps all, \`largest\` the one with the largest area]:SHEETS:_default' \
'--fill=[Fill holes with at most this number of edges. Borders that span more than half of the area of their component are outlines, and stay]:EDGES:_default' \
'--slivers=[Remove triangles with an angle below this one, in degrees, by flips and collapses of edges]:DEGREES:_default' \
'-o+[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and faces are kept in .vtp]:OUTPUT:_files' \
'--output=[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and faces are kept in .vtp]:OUTPUT:_files' \
'--outward[Turn closed components that are inside out, even if they are valid]' \
'--drop-unused[Leave out vertices in no triangle of the file, too]' \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(smooth)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--scale=[Number of neighbours of the fits, 28 to 4096, whatever the noise is\: more of them smooth more. The fits have degree 4. By default number and degree are chosen from the noise]:NEIGHBOURS:_default' \
'(--scale)--flow=[Smooth by one implicit step of mean-curvature flow instead, of this time\: a length squared, in the unit of the file. Waves of length L are multiplied by 1/(1 + 39.5 TIME/L²)]:TIME:_default' \
'-o+[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and triangles are kept in .vtp]:OUTPUT:_files' \
'--output=[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and triangles are kept in .vtp]:OUTPUT:_files' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(split)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--least=[Leave out components with fewer vertices, such as specks of a segmentation]:VERTICES:_default' \
'--format=[Format of the files\: .obj, .off, .stl, .ply, .vtp and .glb. Numbers at vertices and triangles are kept in .vtp]:ENDING:_default' \
'-o+[Folder for the files component-1, component-2 and so on, in the order of their first vertices]:OUT:_files' \
'--out=[Folder for the files component-1, component-2 and so on, in the order of their first vertices]:OUT:_files' \
'-h[Print help]' \
'--help[Print help]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(subdivide)
_arguments "${_arguments_options[@]}" : \
'--weld=[Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have separate vertices for each face]::DISTANCE:_default' \
'--levels=[Number of refinements]:LEVELS:_default' \
'-o+[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb]:OUTPUT:_files' \
'--output=[Output file; its ending determines the format\: .obj, .off, .stl, .ply, .vtp and .glb]:OUTPUT:_files' \
'--limit[Place the vertices on the smooth surface to which further refinement would converge]' \
'-h[Print help]' \
'--help[Print help]' \
':mesh -- Mesh file\: .obj, .off, .stl, .ply, .vtp, .vtu, .pvtp, .pvtu, .vtm, .vtk, .glb, .gltf, .msh, .gii and .3mf, also compressed as .gz:_files' \
&& ret=0
;;
(run)
_arguments "${_arguments_options[@]}" : \
'*--set=[Replace a value of the scene, as in \`surface.vesicle.bending.modulus=0.3\`, or remove it, as in \`surface.vesicle.bending=\`; may be repeated]:PATH=VALUE:_default' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'--out=[Output folder; by default the scene'\''s name without \`.toml\`]:OUT:_files' \
'--resume[Continue the run in the folder from its last checkpoint]' \
'(--resume --out)--check[Only report problems of the scene]' \
'-h[Print help]' \
'--help[Print help]' \
':scene -- TOML file, or the name of a scene that comes with the program\: see `helfrich scenes`:_files' \
&& ret=0
;;
(sweep)
_arguments "${_arguments_options[@]}" : \
'*--set=[Replace a value of the scene, as in \`surface.vesicle.bending.modulus=0.3\`, or remove it, as in \`surface.vesicle.bending=\`; may be repeated]:PATH=VALUE:_default' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'--out=[Output folder, with a subfolder for each run]:OUT:_files' \
'*--vary=[A key and its values, as in \`surface.0.bending.method=meyer,juelicher\`; may be repeated, and the last key varies fastest. Commas inside brackets, braces and quotation marks belong to a value]:PATH=VALUE,VALUE:_default' \
'*--columns=[Columns of the series to show and to plot; by default those of the scene'\''s plots]:COLUMNS:_default' \
'--part=[Run only the Kth of N parts\: every Nth combination from the Kth on. Other processes, also on other machines, may run other parts in the same folder at the same time; the same command with \`--resume\` and without this compares all runs]:K/N:_default' \
'--jobs=[Number of simultaneous runs, from 1 to 1024, which share the threads equally. As many jobs as threads suit runs with small meshes]:N:_default' \
'--resume[Continue the runs in the folder; runs that have ended are skipped]' \
'-h[Print help]' \
'--help[Print help]' \
':scene -- TOML file, or the name of a scene that comes with the program\: see `helfrich scenes`:_files' \
&& ret=0
;;
(scenes)
_arguments "${_arguments_options[@]}" : \
'--out=[Write the scenes to this folder, with the files that they need and their JSON schema. Existing files are not overwritten]:FOLDER:_files' \
'-h[Print help]' \
'--help[Print help]' \
&& ret=0
;;
(paper)
_arguments "${_arguments_options[@]}" : \
'-o+[Output folder\: the page \`index.html\`, and the runs of scenes in \`runs\`]:FOLDER:_files' \
'--out=[Output folder\: the page \`index.html\`, and the runs of scenes in \`runs\`]:FOLDER:_files' \
'*--part=[Parts of the page; by default all]:PART:((curvature\:"Curvatures and forces on the exact red blood cell, over refinement and families of meshes"
capsule\:"The capsule in shear flow by both solvers, and what others found"
precision\:"f32 beside f64\: errors and times in every number type"))' \
'*--method=[Methods by name or letter; by default A,B,C,D,E,S,G,J6. On the lattice those of B, C, S and J6 among them]:METHOD:_default' \
'*--vertices=[Numbers of vertices of the red blood cell. By default 642,2562,10242,40962; with \`--quick\` 162,642,2562]:VERTICES:_default' \
'--figures=[Also write every figure of the page as SVG and PNG to this folder]:FOLDER:_files' \
'--cache=[File in which measurements are kept, so that a repeated or interrupted study reuses them; by default, for pages only, in the user'\''s cache folder]:FILE:_files' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'--quick[Take coarser meshes and shorter runs\: less than a minute instead of ten]' \
'--fresh[Measure everything again]' \
'-h[Print help (see more with '\''--help'\'')]' \
'--help[Print help (see more with '\''--help'\'')]' \
&& ret=0
;;
(explain)
_arguments "${_arguments_options[@]}" : \
'*--set=[Replace a value of the scene, as in \`surface.vesicle.bending.modulus=0.3\`, or remove it, as in \`surface.vesicle.bending=\`; may be repeated]:PATH=VALUE:_default' \
'--threads=[Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do not depend on it]:N:_default' \
'-h[Print help]' \
'--help[Print help]' \
':scene -- TOML file, or the name of a scene that comes with the program\: see `helfrich scenes`:_files' \
&& ret=0
;;
(help)
_arguments "${_arguments_options[@]}" : \
":: :_helfrich__subcmd__help_commands" \
"*::: :->help" \
&& ret=0

    case $state in
    (help)
        words=($line[1] "${words[@]}")
        (( CURRENT += 1 ))
        curcontext="${curcontext%:*:*}:helfrich-help-command-$line[1]:"
        case $line[1] in
            (study)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(recommend)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(curvature)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(info)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(remesh)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(repair)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(smooth)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(split)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(subdivide)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(run)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(sweep)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(scenes)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(paper)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(explain)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
(help)
_arguments "${_arguments_options[@]}" : \
&& ret=0
;;
        esac
    ;;
esac
;;
        esac
    ;;
esac
}

(( $+functions[_helfrich_commands] )) ||
_helfrich_commands() {
    local commands; commands=(
'study:Measure errors and times of bending methods on exact shapes' \
'recommend:Recommend a method for a mesh file, by measurements on that mesh' \
'curvature:Compute curvatures and force density at every vertex of a mesh file, as CSV or VTP' \
'info:Show counts, topology, area, volume and quality of a mesh file' \
'remesh:Make a new mesh with even triangles of the smooth surface through the vertices of a mesh file' \
'repair:Make a mesh of a file that others refuse, and say what was changed' \
'smooth:Remove the noise of the positions of a mesh file, or smooth them by mean-curvature flow' \
'split:Write each connected component of a mesh file to a file of its own' \
'subdivide:Refine a mesh file by Loop'\''s rules\: four triangles for each triangle and level' \
'run:Run a scene\: surfaces, the effects that act on each, and a driver that moves them' \
'sweep:Run a scene with every combination of given values, and compare the results' \
'scenes:List the scenes that come with the program, which \`run\`, \`sweep\` and \`explain\` take by name' \
'paper:Make the figures of Guckenberger et al. (2016) with ours beside its data, as one page' \
'explain:Explain a scene without running it\: effects, dimensionless groups, memory, step limits' \
'help:Print this message or the help of the given subcommand(s)' \
    )
    _describe -t commands 'helfrich commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__curvature_commands] )) ||
_helfrich__subcmd__curvature_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich curvature commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__explain_commands] )) ||
_helfrich__subcmd__explain_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich explain commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help_commands] )) ||
_helfrich__subcmd__help_commands() {
    local commands; commands=(
'study:Measure errors and times of bending methods on exact shapes' \
'recommend:Recommend a method for a mesh file, by measurements on that mesh' \
'curvature:Compute curvatures and force density at every vertex of a mesh file, as CSV or VTP' \
'info:Show counts, topology, area, volume and quality of a mesh file' \
'remesh:Make a new mesh with even triangles of the smooth surface through the vertices of a mesh file' \
'repair:Make a mesh of a file that others refuse, and say what was changed' \
'smooth:Remove the noise of the positions of a mesh file, or smooth them by mean-curvature flow' \
'split:Write each connected component of a mesh file to a file of its own' \
'subdivide:Refine a mesh file by Loop'\''s rules\: four triangles for each triangle and level' \
'run:Run a scene\: surfaces, the effects that act on each, and a driver that moves them' \
'sweep:Run a scene with every combination of given values, and compare the results' \
'scenes:List the scenes that come with the program, which \`run\`, \`sweep\` and \`explain\` take by name' \
'paper:Make the figures of Guckenberger et al. (2016) with ours beside its data, as one page' \
'explain:Explain a scene without running it\: effects, dimensionless groups, memory, step limits' \
'help:Print this message or the help of the given subcommand(s)' \
    )
    _describe -t commands 'helfrich help commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__curvature_commands] )) ||
_helfrich__subcmd__help__subcmd__curvature_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help curvature commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__explain_commands] )) ||
_helfrich__subcmd__help__subcmd__explain_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help explain commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__help_commands] )) ||
_helfrich__subcmd__help__subcmd__help_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help help commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__info_commands] )) ||
_helfrich__subcmd__help__subcmd__info_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help info commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__paper_commands] )) ||
_helfrich__subcmd__help__subcmd__paper_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help paper commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__recommend_commands] )) ||
_helfrich__subcmd__help__subcmd__recommend_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help recommend commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__remesh_commands] )) ||
_helfrich__subcmd__help__subcmd__remesh_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help remesh commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__repair_commands] )) ||
_helfrich__subcmd__help__subcmd__repair_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help repair commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__run_commands] )) ||
_helfrich__subcmd__help__subcmd__run_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help run commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__scenes_commands] )) ||
_helfrich__subcmd__help__subcmd__scenes_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help scenes commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__smooth_commands] )) ||
_helfrich__subcmd__help__subcmd__smooth_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help smooth commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__split_commands] )) ||
_helfrich__subcmd__help__subcmd__split_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help split commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__study_commands] )) ||
_helfrich__subcmd__help__subcmd__study_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help study commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__subdivide_commands] )) ||
_helfrich__subcmd__help__subcmd__subdivide_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help subdivide commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__help__subcmd__sweep_commands] )) ||
_helfrich__subcmd__help__subcmd__sweep_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich help sweep commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__info_commands] )) ||
_helfrich__subcmd__info_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich info commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__paper_commands] )) ||
_helfrich__subcmd__paper_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich paper commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__recommend_commands] )) ||
_helfrich__subcmd__recommend_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich recommend commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__remesh_commands] )) ||
_helfrich__subcmd__remesh_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich remesh commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__repair_commands] )) ||
_helfrich__subcmd__repair_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich repair commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__run_commands] )) ||
_helfrich__subcmd__run_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich run commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__scenes_commands] )) ||
_helfrich__subcmd__scenes_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich scenes commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__smooth_commands] )) ||
_helfrich__subcmd__smooth_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich smooth commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__split_commands] )) ||
_helfrich__subcmd__split_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich split commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__study_commands] )) ||
_helfrich__subcmd__study_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich study commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__subdivide_commands] )) ||
_helfrich__subcmd__subdivide_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich subdivide commands' commands "$@"
}
(( $+functions[_helfrich__subcmd__sweep_commands] )) ||
_helfrich__subcmd__sweep_commands() {
    local commands; commands=()
    _describe -t commands 'helfrich sweep commands' commands "$@"
}

if [ "$funcstack[1]" = "_helfrich" ]; then
    _helfrich "$@"
else
    compdef _helfrich helfrich
fi
