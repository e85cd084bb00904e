"""
Native half of doublet; use the package `doublet`.
"""
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import os
import pathlib
import typing
__all__: list[str] = ['AlignedScan', 'AnimateOptions', 'AnimationFrame', 'AnimationResult', 'AnnealingOptions', 'BackgroundOptions', 'BakedGlbOptions', 'BayesianOptions', 'BodyFit', 'BodyFitOptions', 'BodyFitter', 'BodyModel', 'BodyRegion', 'CalibratedCamera', 'CalibrationOptions', 'CalibrationRefinementOptions', 'Camera', 'CameraView', 'Capsule', 'CaptureOptions', 'CaptureParts', 'CaptureResult', 'CaptureSummary', 'Character', 'CharacterRenderer', 'CharacterSimulator', 'CharacterState', 'ChromaKeyOptions', 'ClothModel', 'ClothOptions', 'ClothRegion', 'ClothSegmenter', 'ClothSolver', 'ClothState', 'ClothedScan', 'CmaEsOptions', 'Context', 'DetectedJoints', 'DisplayMesh', 'DisplaySurface', 'DressedActor', 'EnergyOptions', 'Error', 'FeatureTracker', 'FeatureTrackerOptions', 'Features', 'Finding', 'FitFinding', 'FitOptions', 'FitResult', 'FootContacts', 'FrameSource', 'FrameViews', 'Garment', 'GarmentMesher', 'GarmentOptions', 'GarmentSummary', 'GenerationRow', 'HeatWeightOptions', 'Implausible', 'JointAnnotation', 'JointMatch', 'JointVisibility', 'Lens', 'Limb', 'LimbProblem', 'LimbSearch', 'LimbSearchOptions', 'Limit', 'LostLimb', 'Material', 'MaterialObjective', 'Mesh', 'MeshReport', 'MeshSequence', 'MinimiseOptions', 'MinimiseResult', 'Motion', 'Objective', 'Observations', 'OppositeOptions', 'Optimizer', 'OptimizerResult', 'Outline', 'ParameterSpace', 'ParticleAnnealingOptions', 'PerformanceCapture', 'PlantOptions', 'Player', 'PoseEstimate', 'PoseOptimizer', 'PoseOptions', 'PoseProblem', 'PosedFrame', 'Posterior', 'ProxyOptions', 'ProxyStatistics', 'RayScene', 'Reconstruction', 'ReconstructionOptions', 'ReferencePerformance', 'RefinedCamera', 'RenderMesh', 'RenderOptions', 'RestPoseOptions', 'Results', 'RetargetOptions', 'RiggedMesh', 'RunRecord', 'SegmentInputs', 'SegmentOptions', 'SegmentSummary', 'Segmentation', 'Session', 'SessionCamera', 'SessionCheck', 'SilhouetteExtractor', 'SilhouetteOptions', 'Skeleton', 'SolverSettings', 'SourceMotion', 'Stage', 'StartFrame', 'StepInputs', 'SurfaceEstimate', 'SurfaceOptions', 'SurfaceProblem', 'SurfaceQuality', 'SurfaceRefiner', 'SurfaceTrack', 'SurfaceTransfer', 'Take', 'TaperedCapsule', 'Template', 'TemplateOptions', 'TemplateSummary', 'TextureOptions', 'TrainOptions', 'TrainSummary', 'ViewObservation', 'ViewScanOptions', 'align_scan', 'animate', 'animate_each', 'apply_corrections', 'body_fitter_violations', 'body_model_violations', 'body_regions', 'build_display_mesh', 'build_template', 'canonical_frames', 'capsule_mesh', 'check_session', 'choose_widths', 'cloth_prior', 'cloth_segmenter_violations', 'cloth_solver_violations', 'common_widths', 'create_bayesian', 'create_cma_es', 'create_simulated_annealing', 'default_stages', 'detect_joints', 'distances_to_surface', 'dress', 'dual_quaternion_skinning', 'estimate_material', 'explain_match', 'face_areas', 'face_normals', 'feature_tracker_violations', 'filmed', 'find_contacts', 'find_limbs', 'find_start_frame', 'findings_to_json', 'fit_proxies', 'fit_together', 'frame_source_violations', 'garment_mesher_violations', 'hash_files', 'heat_weights', 'hidden_faces', 'limb_search_violations', 'make_character', 'material_energy', 'measure_observations', 'mesh_garment', 'minimise', 'objective_violations', 'optimizer_violations', 'orbit_camera', 'performance_capture_violations', 'plant_feet', 'pose_optimizer_violations', 'pose_surface', 'posterior_of', 'proxy_statistics', 'quality_findings', 'quality_limits', 'rasterize', 'read_actor', 'read_body', 'read_calibration', 'read_found_segmentation', 'read_garment', 'read_materials', 'read_mesh', 'read_observations', 'read_performance', 'read_proxies', 'read_segmentation', 'read_segmentation_paint', 'read_simulated', 'read_suggested_mask', 'read_template_mask', 'read_view', 'read_views', 'read_widths', 'refine_rest_pose', 'render', 'require_scanned', 'resample', 'resolve_arm_penetration', 'retarget', 'rig_template', 'sample_colours', 'scan_from_views', 'segment_cloth', 'segment_performance', 'segmentation_pose', 'self_intersecting_faces', 'session_silhouettes', 'silhouette_extractor_violations', 'simulate_reference', 'spring_constant', 'step_players', 'stiffness_of_spring', 'summarise_garment', 'summarise_segmentation', 'summarise_template', 'surface_refiner_violations', 'texture_character', 'texture_character_from_take', 'trace_outline', 'train_body_model', 'triangulate', 'vertex_areas', 'vertex_normals', 'visible_vertices', 'width_variants', 'write_actor', 'write_baked_glb', 'write_baked_npz', 'write_body', 'write_bvh', 'write_calibration', 'write_garment', 'write_materials', 'write_mesh', 'write_observations', 'write_performance', 'write_proxies', 'write_segmentation', 'write_segmentation_paint', 'write_simulated', 'write_template_mask', 'write_template_suggestion']
class Error(RuntimeError):
    pass
class Context:
    """
    Progress, log, cancellation and threads of a long call. Ctrl-C always works.
    """
    def __init__(self, *, progress: collections.abc.Callable[[str, float], None] = None, log: collections.abc.Callable[[str], None] = None, threads: int = 0) -> None:
        """
        progress(stage, fraction in [0, 1]); log(line); threads: 0 = one a core, results do not depend on it.
        """
    def __repr__(self) -> str:
        ...
    def log_line(self, line: str) -> None:
        """
        Hands a line to log.
        """
    def report_progress(self, stage: str, fraction: float) -> None:
        """
        Tells progress(stage, fraction); raises KeyboardInterrupt if the user asked to stop.
        """
    @property
    def threads(self) -> int:
        """
        0 = one a core; results do not depend on it
        """
    @threads.setter
    def threads(self, value: int) -> None:
        ...
class Finding:
    """
    What is wrong with a session or a result: impossible stops a run, doubtful is only said.
    """
    def __init__(self, impossible: bool, text: str, kind: str = '') -> None:
        ...
    def __repr__(self) -> str:
        ...
    @property
    def impossible(self) -> bool:
        """
        nothing should be built on it
        """
    @property
    def kind(self) -> str:
        """
        a word for programs; may be empty
        """
    @property
    def level(self) -> str:
        """
        'impossible' or 'doubtful'
        """
    @property
    def text(self) -> str:
        """
        one sentence that names expectation and finding
        """
class MeshReport:
    """
    What is wrong, or right, with a mesh.
    """
    def __repr__(self) -> str:
        ...
    @property
    def boundary_edges(self) -> int:
        """
        edges of one face
        """
    @property
    def closed(self) -> bool:
        """
        no boundary, and manifold
        """
    @property
    def components(self) -> int:
        """
        connected components of faces
        """
    @property
    def degenerate_faces(self) -> int:
        """
        a repeated corner, or an area below 1e-14 m^2
        """
    @property
    def faces(self) -> int:
        """
        F
        """
    @property
    def non_finite_vertices(self) -> int:
        """
        with NaN or infinity
        """
    @property
    def non_manifold_edges(self) -> int:
        """
        edges of more than two faces, or of two in the same direction
        """
    @property
    def out_of_range_faces(self) -> int:
        """
        a corner index < 0 or >= V
        """
    @property
    def unused_vertices(self) -> int:
        """
        of no face
        """
    @property
    def usable(self) -> bool:
        """
        finite, in range, not empty: what no stage can do without
        """
    @property
    def vertices(self) -> int:
        """
        V
        """
class Mesh:
    """
    Triangle mesh: vertices (V, 3) m, faces (F, 3).
    """
    @typing.overload
    def __init__(self) -> None:
        ...
    @typing.overload
    def __init__(self, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> None:
        ...
    def report(self) -> MeshReport:
        """
        What is wrong, or right, with the mesh.
        """
    @property
    def faces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        (F, 3) indices of vertices
        """
    @faces.setter
    def faces(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> None:
        ...
    @property
    def vertices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
    @vertices.setter
    def vertices(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
class MeshSequence:
    """
    A deforming surface: faces (F, 3), frames (T, V, 3) m.
    """
    @typing.overload
    def __init__(self) -> None:
        ...
    @typing.overload
    def __init__(self, faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], frames: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    def __len__(self) -> int:
        ...
    @property
    def faces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        (F, 3)
        """
    @faces.setter
    def faces(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> None:
        ...
    @property
    def frames(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (T, V, 3) m; a copy that cannot be written to: set it as a whole
        """
    @frames.setter
    def frames(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
class Camera:
    """
    Pinhole camera, OpenCV's conventions: x_cam = R x_world + t.
    """
    def __init__(self) -> None:
        ...
    def project(self, point: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"]:
        """
        Pixel of a world point.
        """
    def resized(self, width: int, height: int) -> Camera:
        """
        The same camera for images of another size.
        """
    @property
    def K(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]:
        """
        (3, 3) pixels: focal lengths and principal point
        """
    @K.setter
    def K(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"]) -> None:
        ...
    @property
    def R(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]:
        """
        (3, 3) of cam_from_world
        """
    @R.setter
    def R(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 3]"]) -> None:
        ...
    @property
    def centre(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, where the camera stands
        """
    @property
    def distortion(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[5, 1]"]:
        """
        k1 k2 p1 p2 k3
        """
    @distortion.setter
    def distortion(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[5, 1]"]) -> None:
        ...
    @property
    def height(self) -> int:
        """
        of the images, pixels
        """
    @height.setter
    def height(self, value: int) -> None:
        ...
    @property
    def name(self) -> str:
        """
        of the camera, as files have it
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def t(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, of cam_from_world
        """
    @t.setter
    def t(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def width(self) -> int:
        """
        of the images, pixels
        """
    @width.setter
    def width(self, value: int) -> None:
        ...
class JointAnnotation:
    """
    A joint as the user marks it.
    """
    def __init__(self, name: str, parent: str, position: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], dof: int | None = None) -> None:
        ...
    @property
    def dof(self) -> int | None:
        """
        rotational degrees of freedom; None = as usual for a joint of this name
        """
    @dof.setter
    def dof(self, value: int | None) -> None:
        ...
    @property
    def name(self) -> str:
        """
        of the joint
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def parent(self) -> str:
        """
        name of the joint that carries it; empty = the root
        """
    @parent.setter
    def parent(self, value: str) -> None:
        ...
    @property
    def position(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m
        """
    @position.setter
    def position(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
class Skeleton:
    """
    Kinematic skeleton; joints are sorted parents first.
    """
    def __init__(self, marks: collections.abc.Sequence[JointAnnotation]) -> None:
        ...
    def find(self, name: str) -> int:
        """
        Index of a joint; raises Error if there is none of that name.
        """
    def forward_kinematics(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> numpy.typing.NDArray[numpy.float64]:
        """
        (J, 4, 4) world_from_rest
        """
    def joint_positions(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (J, 3) m
        """
    @property
    def dof_names(self) -> list[str]:
        """
        (D)
        """
    @property
    def joint_names(self) -> list[str]:
        """
        (J)
        """
    @property
    def joint_parents(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"]:
        """
        (J) indices, -1 = none
        """
    @property
    def joint_rest(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (J, 3) m, scan pose
        """
    @property
    def lower(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D) least value of each degree of freedom, rad or m
        """
    @property
    def upper(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D) greatest value
        """
class ViewObservation:
    """
    2D data of one camera at one frame, pixels.
    """
    def __init__(self, contour: typing.Annotated[numpy.typing.ArrayLike, numpy.float32, "[m, 2]"], matches: typing.Annotated[numpy.typing.ArrayLike, numpy.float32, "[m, 4]"]) -> None:
        ...
    @property
    def contour(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, 2]"]:
        """
        (N, 2) boundary of the measured silhouette
        """
    @property
    def matches(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, 4]"]:
        """
        (N, 4) features at t-1 (x, y) and t (x, y)
        """
class Observations:
    """
    2D data of the whole sequence (observations.npz).
    """
    def __init__(self) -> None:
        ...
    @property
    def cameras(self) -> list[Camera]:
        """
        names
        """
    @cameras.setter
    def cameras(self, value: collections.abc.Sequence[Camera]) -> None:
        ...
    @property
    def frames(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        (T) video frame numbers
        """
    @frames.setter
    def frames(self, value: collections.abc.Sequence[int]) -> None:
        ...
    @property
    def views(self) -> list[list[ViewObservation]]:
        """
        [frame][camera]; a copy
        """
    @views.setter
    def views(self, value: collections.abc.Sequence[collections.abc.Sequence[ViewObservation]]) -> None:
        ...
class RiggedMesh:
    """
    Surface in the scan pose, skeleton and skin weights (actor.npz).
    """
    def __init__(self, mesh: Mesh, face_valid: numpy.typing.ArrayLike, weights: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"], skeleton: Skeleton) -> None:
        ...
    @property
    def face_valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (F) 0 = invented over a large hole
        """
    @face_valid.setter
    def face_valid(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def mesh(self) -> Mesh:
        """
        scan pose, m
        """
    @mesh.setter
    def mesh(self, value: Mesh) -> None:
        ...
    @property
    def skeleton(self) -> Skeleton:
        """
        Skeleton
        """
    @skeleton.setter
    def skeleton(self, value: Skeleton) -> None:
        ...
    @property
    def weights(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (V, J)
        """
    @weights.setter
    def weights(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
class ReferencePerformance:
    """
    The captured performance (performance.npz).
    """
    def __init__(self) -> None:
        ...
    @property
    def dofs(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (T, D)
        """
    @dofs.setter
    def dofs(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
    @property
    def frames(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        (T) video frame numbers
        """
    @frames.setter
    def frames(self, value: collections.abc.Sequence[int]) -> None:
        ...
    @property
    def joints(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (T, J, 3) m; a copy that cannot be written to: set it as a whole
        """
    @joints.setter
    def joints(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    @property
    def surface(self) -> MeshSequence:
        """
        MeshSequence of the captured surface
        """
    @surface.setter
    def surface(self, value: MeshSequence) -> None:
        ...
class Segmentation:
    """
    Which vertices are loose cloth (segmentation.npz).
    """
    @typing.overload
    def __init__(self) -> None:
        ...
    @typing.overload
    def __init__(self, sigma: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], clothness: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], region: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"]) -> None:
        ...
    @property
    def clothness(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) in [0, 1]
        """
    @clothness.setter
    def clothness(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def probability(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) in [0, 1], of being cloth; empty = not told
        """
    @probability.setter
    def probability(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def region(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"]:
        """
        (V), -1 = rigid
        """
    @region.setter
    def region(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"]) -> None:
        ...
    @property
    def region_count(self) -> int:
        """
        cloth regions
        """
    @region_count.setter
    def region_count(self, value: int) -> None:
        ...
    @property
    def rest(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m, the shape that lengths and masses come from; empty = the scan pose
        """
    @rest.setter
    def rest(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def sigma(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) m
        """
    @sigma.setter
    def sigma(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
class Garment:
    """
    All cloth of a character as a mesh of its own (garment.npz).
    """
    def __init__(self) -> None:
        ...
    @property
    def actor_face(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"]:
        """
        (G) face of the actor on which the vertex lies
        """
    @actor_face.setter
    def actor_face(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"]) -> None:
        ...
    @property
    def barycentric(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (G, 3) of that face's corners
        """
    @barycentric.setter
    def barycentric(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def clothness(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (G) 0 = hangs on the skeleton, 1 = free
        """
    @clothness.setter
    def clothness(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def mesh(self) -> Mesh:
        """
        scan pose, m
        """
    @mesh.setter
    def mesh(self, value: Mesh) -> None:
        ...
    @property
    def region(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"]:
        """
        (G)
        """
    @region.setter
    def region(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"]) -> None:
        ...
    @property
    def region_count(self) -> int:
        """
        cloth regions
        """
    @region_count.setter
    def region_count(self, value: int) -> None:
        ...
    @property
    def replaced_faces(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (F) faces of the actor that the garment stands for
        """
    @replaced_faces.setter
    def replaced_faces(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def rest(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (G, 3) m, the shape that lengths and masses come from
        """
    @rest.setter
    def rest(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def widths(self) -> list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]]:
        """
        [K] (G, 3) m, rest shapes to choose from, the widest first; empty = `rest` alone
        """
    @widths.setter
    def widths(self, value: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]]) -> None:
        ...
class DressedActor:
    """
    The actor in a garment of its own mesh.
    """
    @property
    def actor(self) -> RiggedMesh:
        """
        V + G vertices: the actor's, then the garment's
        """
    @actor.setter
    def actor(self, value: RiggedMesh) -> None:
        ...
    @property
    def segmentation(self) -> Segmentation:
        """
        of the V + G vertices
        """
    @segmentation.setter
    def segmentation(self, value: Segmentation) -> None:
        ...
class TaperedCapsule:
    """
    Collision proxy carried by a joint.
    """
    def __init__(self, joint: int, p0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], p1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], r0: float, r1: float) -> None:
        ...
    @property
    def joint(self) -> int:
        """
        index of the joint that carries it
        """
    @joint.setter
    def joint(self, value: int) -> None:
        ...
    @property
    def p0(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, one end of the axis, scan pose
        """
    @p0.setter
    def p0(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def p1(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, the other end
        """
    @p1.setter
    def p1(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def r0(self) -> float:
        """
        m, radius at p0
        """
    @r0.setter
    def r0(self, value: float) -> None:
        ...
    @property
    def r1(self) -> float:
        """
        m, radius at p1
        """
    @r1.setter
    def r1(self, value: float) -> None:
        ...
class BodyFit:
    """
    The body under the clothes, scan pose (body.npz).
    """
    def __init__(self) -> None:
        ...
    @property
    def body(self) -> Mesh:
        """
        the body's mesh, scan pose, m
        """
    @body.setter
    def body(self, value: Mesh) -> None:
        ...
    @property
    def coefficients(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        of the statistical model
        """
    @coefficients.setter
    def coefficients(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def deviation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (B) m, expected RMS error of each vertex; empty = not known
        """
    @deviation.setter
    def deviation(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def model(self) -> str:
        """
        name and hash of the statistical model
        """
    @model.setter
    def model(self, value: str) -> None:
        ...
    @property
    def residual(self) -> float:
        """
        m
        """
    @residual.setter
    def residual(self, value: float) -> None:
        ...
class RayScene:
    """
    Rays and closest points against one mesh.
    """
    def __init__(self, mesh: Mesh, face_valid: numpy.typing.ArrayLike = []) -> None:
        ...
    def cast(self, origins: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], min_distance: float = 0.0) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
        """
        (face, distance) of the first hits of N rays; face -1 and distance inf where there is none.
        """
    def closest(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]]:
        """
        (face, distance, point) of the closest surface point of N points.
        """
class CalibrationOptions:
    """
    Options of read_calibration.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> CalibrationOptions:
        ...
    def __deepcopy__(self, memo: dict) -> CalibrationOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, format: typing.Literal['found', 'doublet', 'opencv', 'colmap', 'easymocap', 'toml', 'qualisys', 'anipose', 'panoptic', 'metashape', 'opencv_fisheye'] = 'found', units: str = 'found', up: typing.Literal['found', 'x', '-x', 'y', '-y', 'z', '-z'] = 'found', image_width: int = 0, image_height: int = 0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def format(self) -> str:
        """
        Format of the file or folder; found = by its names and content: one of 'found', 'doublet', 'opencv', 'colmap', 'easymocap', 'toml', 'qualisys', 'anipose', 'panoptic', 'metashape', 'opencv_fisheye'
        """
    @format.setter
    def format(self, value: str) -> None:
        ...
    @property
    def image_height(self) -> int:
        """
        px, Height of the images, where the format does not have it; 0 = it has: a number of at least 0
        """
    @image_height.setter
    def image_height(self, value: int) -> None:
        ...
    @property
    def image_width(self) -> int:
        """
        px, Width of the images, where the format does not have it; 0 = it has: a number of at least 0
        """
    @image_width.setter
    def image_width(self, value: int) -> None:
        ...
    @property
    def units(self) -> str:
        """
        Unit of the file: m, cm, mm, or metres a unit; found = what the format usually has
        """
    @units.setter
    def units(self, value: str) -> None:
        ...
    @property
    def up(self) -> str:
        """
        Axis of the file that points up; found = the format's, if cameras stand upright: one of 'found', 'x', '-x', 'y', '-y', 'z', '-z'
        """
    @up.setter
    def up(self, value: str) -> None:
        ...
class Lens:
    """
    What Camera.distortion cannot describe: undone when a session reads images.
    """
    def __init__(self) -> None:
        ...
    @property
    def distortion(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        fisheye: k1 .. k4; otherwise 8, 12 or 14 terms; empty = none
        """
    @distortion.setter
    def distortion(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def fisheye(self) -> bool:
        """
        OpenCV's fisheye model; otherwise its extensions of Brown's
        """
    @fisheye.setter
    def fisheye(self, value: bool) -> None:
        ...
    @property
    def needs_undistortion(self) -> bool:
        """
        whether there is anything to undo
        """
class CalibratedCamera:
    """
    A camera as it was calibrated, and its lens.
    """
    def __init__(self, camera: Camera, lens: Lens = ..., late: int = 0) -> None:
        ...
    def project(self, point: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"]:
        """
        Pixel of a world point in the image as it was filmed.
        """
    def project_jacobian(self, point: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 3]"]:
        """
        (2, 3) pixels per metre.
        """
    @property
    def camera(self) -> Camera:
        """
        its distortion is zero where the lens is undone
        """
    @camera.setter
    def camera(self, value: Camera) -> None:
        ...
    @property
    def late(self) -> int:
        """
        frames: what it films in frame t + late the others film in frame t
        """
    @late.setter
    def late(self, value: int) -> None:
        ...
    @property
    def lens(self) -> Lens:
        """
        what is undone when frames are read
        """
    @lens.setter
    def lens(self, value: Lens) -> None:
        ...
class SessionCamera:
    """
    One camera of a session and its files.
    """
    def __init__(self) -> None:
        ...
    @property
    def background(self) -> pathlib.Path:
        """
        image of the empty stage or pattern of several; empty = none
        """
    @background.setter
    def background(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def first_frame(self) -> int:
        """
        of video and masks: frame 0 of the session
        """
    @first_frame.setter
    def first_frame(self, value: int) -> None:
        ...
    @property
    def late(self) -> int:
        """
        frames, as CalibratedCamera.late
        """
    @late.setter
    def late(self, value: int) -> None:
        ...
    @property
    def masks(self) -> pathlib.Path:
        """
        the same kinds; empty = key the video
        """
    @masks.setter
    def masks(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def name(self) -> str:
        """
        of the camera
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def video(self) -> pathlib.Path:
        """
        mp4 or printf pattern of images; empty if there are only masks
        """
    @video.setter
    def video(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def video_fps(self) -> float:
        """
        what the video's container says; 0 = nothing
        """
class Session:
    """
    A capture session on disk, checked as a whole.
    """
    @typing.overload
    def __init__(self) -> None:
        """
        Empty, to be filled by hand: one that is nowhere on disk.
        """
    @typing.overload
    def __init__(self, folder: os.PathLike | str | bytes) -> None:
        ...
    def recalibrated(self, calibration: os.PathLike | str | bytes) -> Session:
        """
        The session with the cameras of another calibration.yml, such as the refined one of a capture.
        """
    @property
    def calibration(self) -> pathlib.Path:
        """
        absolute
        """
    @calibration.setter
    def calibration(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def cameras(self) -> list[SessionCamera]:
        """
        SessionCameras
        """
    @cameras.setter
    def cameras(self, value: collections.abc.Sequence[SessionCamera]) -> None:
        ...
    @property
    def folder(self) -> pathlib.Path:
        """
        absolute
        """
    @folder.setter
    def folder(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def fps(self) -> float:
        """
        frames a second
        """
    @fps.setter
    def fps(self, value: float) -> None:
        ...
    @property
    def frame_count(self) -> int:
        """
        of every camera
        """
    @frame_count.setter
    def frame_count(self, value: int) -> None:
        ...
    @property
    def joints(self) -> list[JointAnnotation]:
        """
        JointMarks of joints.json
        """
    @joints.setter
    def joints(self, value: collections.abc.Sequence[JointAnnotation]) -> None:
        ...
    @property
    def landmarks(self) -> dict[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]]:
        """
        name -> (3) m, clicked on the body's surface
        """
    @landmarks.setter
    def landmarks(self, value: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]]) -> None:
        ...
    @property
    def lenses(self) -> list[Lens]:
        """
        undone when images are read; one for each camera
        """
    @lenses.setter
    def lenses(self, value: collections.abc.Sequence[Lens]) -> None:
        ...
    @property
    def markers(self) -> pathlib.Path:
        """
        joints.json, absolute; empty if there is none
        """
    @markers.setter
    def markers(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def name(self) -> str:
        """
        of the session
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def new_motion(self) -> pathlib.Path:
        """
        absolute; empty if there is none
        """
    @new_motion.setter
    def new_motion(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def rig(self) -> list[Camera]:
        """
        a Camera for each of `cameras`
        """
    @rig.setter
    def rig(self, value: collections.abc.Sequence[Camera]) -> None:
        ...
    @property
    def scan(self) -> pathlib.Path:
        """
        absolute; empty if there is none
        """
    @scan.setter
    def scan(self, value: os.PathLike | str | bytes) -> None:
        ...
class FrameSource:
    """
    Swap point: where the images and masks come from.
    """
    @staticmethod
    def open(session: Session) -> FrameSource:
        """
        Images and masks of a session, read as they are asked for.
        """
    def __init__(self) -> None:
        ...
    def image(self, camera: int, frame: int) -> numpy.typing.NDArray[numpy.uint8]:
        """
        (H, W, 3) uint8, BGR
        """
    def mask(self, camera: int, frame: int) -> numpy.typing.NDArray[numpy.uint8]:
        """
        (H, W) uint8, 255 = actor
        """
    @property
    def camera_count(self) -> int:
        """
        of the session
        """
    @property
    def frame_count(self) -> int:
        """
        of each camera
        """
class ChromaKeyOptions:
    """
    Options of the built-in SilhouetteExtractor.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> ChromaKeyOptions:
        ...
    def __deepcopy__(self, memo: dict) -> ChromaKeyOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, min_blob_area: int = 200, min_key_share: float = 0.5) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def min_blob_area(self) -> int:
        """
        px, Smaller islands and holes of the mask are dropped; at 1004 x 1004, scaled with the image area: a number of at least 0
        """
    @min_blob_area.setter
    def min_blob_area(self, value: int) -> None:
        ...
    @property
    def min_key_share(self) -> float:
        """
        Share of the image border that must show one saturated hue: a number in (0, 1]. With less there is no screen to key against
        """
    @min_key_share.setter
    def min_key_share(self, value: float) -> None:
        ...
class BackgroundOptions:
    """
    Options of silhouettes by the difference to a background.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> BackgroundOptions:
        ...
    def __deepcopy__(self, memo: dict) -> BackgroundOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, smoothness: float = 8.0, shadow: float = 0.55, highlight: float = 1.25, min_blob_area: int = 200) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def highlight(self) -> float:
        """
        Background may be brightened to this share of its brightness: a number of at least 1
        """
    @highlight.setter
    def highlight(self, value: float) -> None:
        ...
    @property
    def min_blob_area(self) -> int:
        """
        px, Smaller islands and holes of the mask are dropped; at 1004 x 1004, scaled with the image area: a number of at least 0
        """
    @min_blob_area.setter
    def min_blob_area(self, value: int) -> None:
        ...
    @property
    def shadow(self) -> float:
        """
        Background may be darkened by a shadow to this share of its brightness: a number in (0, 1]
        """
    @shadow.setter
    def shadow(self, value: float) -> None:
        ...
    @property
    def smoothness(self) -> float:
        """
        Log likelihood that an edge between two pixels of the same colour costs: a number of at least 0. More fills what looks like the background and loses thin parts
        """
    @smoothness.setter
    def smoothness(self, value: float) -> None:
        ...
class SilhouetteOptions:
    """
    How silhouettes of a session are found.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> SilhouetteOptions:
        ...
    def __deepcopy__(self, memo: dict) -> SilhouetteOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, method: typing.Literal['auto', 'plates', 'key', 'median'] = 'auto', median_frames: int = 25, actor_frames: int = 8, key: ChromaKeyOptions = ..., background: BackgroundOptions = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def actor_frames(self) -> int:
        """
        Number of frames, spread over the session, that the actor's colours before a background are learnt from: a number of at least 0
        """
    @actor_frames.setter
    def actor_frames(self, value: int) -> None:
        ...
    @property
    def background(self) -> BackgroundOptions:
        """
        Options of the difference to a background
        """
    @background.setter
    def background(self, value: BackgroundOptions) -> None:
        ...
    @property
    def key(self) -> ChromaKeyOptions:
        """
        Options of the screen of one colour
        """
    @key.setter
    def key(self, value: ChromaKeyOptions) -> None:
        ...
    @property
    def median_frames(self) -> int:
        """
        Number of frames, spread over the session, that the median is taken of: a number of at least 1
        """
    @median_frames.setter
    def median_frames(self, value: int) -> None:
        ...
    @property
    def method(self) -> str:
        """
        Method: plates, key, median, or auto: the first of these that the session allows, a camera: one of 'auto', 'plates', 'key', 'median'. plates = clean ones of the session, key = a screen of one colour, median = of the frames: the actor must move about
        """
    @method.setter
    def method(self, value: str) -> None:
        ...
class SilhouetteExtractor:
    """
    Swap point: image -> mask (255 = actor).
    """
    @staticmethod
    @typing.overload
    def create(options: ChromaKeyOptions = ...) -> SilhouetteExtractor:
        """
        By a key colour.
        """
    @staticmethod
    @typing.overload
    def create(options: BackgroundOptions) -> SilhouetteExtractor:
        """
        By the difference to a background.
        """
    def __init__(self) -> None:
        ...
    def extract(self, camera: int, image: numpy.typing.NDArray[numpy.uint8]) -> numpy.typing.NDArray[numpy.uint8]:
        """
        Mask (H, W), 255 = actor.
        """
    def learn_actor(self, camera: int, images: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]]) -> None:
        """
        Looks at images of the take, after train(): an extractor may learn what the actor looks like.
        """
    def train(self, camera: int, images: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]]) -> None:
        """
        Looks at images of one camera before the first mask is made.
        """
class CameraView:
    """
    What a camera shows at a frame.
    """
    def __init__(self, image: numpy.typing.NDArray[numpy.uint8] = ..., mask: numpy.typing.NDArray[numpy.uint8] = ...) -> None:
        ...
    @property
    def image(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        (H, W, 3) uint8, BGR; (0, 0) = nothing
        """
    @property
    def mask(self) -> numpy.typing.NDArray[numpy.uint8]:
        """
        (H, W) uint8, 255 = actor; (0, 0) = none
        """
class FrameViews:
    """
    What all cameras of a session show at a frame.
    """
    @property
    def images(self) -> list[numpy.typing.NDArray[numpy.uint8]]:
        """
        (H, W, 3) uint8, BGR, or empty; one a camera
        """
    @property
    def masks(self) -> list[numpy.typing.NDArray[numpy.uint8]]:
        """
        (H, W) uint8, 255 = actor, or empty; one a camera
        """
class StartFrame:
    """
    Where a take is most like the scan.
    """
    @property
    def first_overlap(self) -> float:
        """
        the same in frame 0
        """
    @property
    def frame(self) -> int:
        """
        of the frame source
        """
    @property
    def in_scan_pose(self) -> bool:
        """
        tracking begins there at once: overlap 0.8
        """
    @property
    def near_scan_pose(self) -> bool:
        """
        near enough to search the pose: overlap 0.4
        """
    @property
    def overlap(self) -> float:
        """
        with the silhouettes there, mean over the cameras
        """
    @property
    def world_from_scan(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (4, 4): where the scan is placed
        """
class ViewScanOptions:
    """
    Options of scan_from_views.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> ViewScanOptions:
        ...
    def __deepcopy__(self, memo: dict) -> ViewScanOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, cell: float = 0.006, poisson_depth: int = 9, max_missing_views: int = 0, search_depth: float = 0.08, patch: float = 0.035, smoothness: float = 0.3, grazing_angle: float = 1.3962634015954636) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def cell(self) -> float:
        """
        m, Size of a cell of the grid that the visual hull is sampled on: a number in [0.001, 0.05]
        """
    @cell.setter
    def cell(self, value: float) -> None:
        ...
    @property
    def grazing_angle(self) -> float:
        """
        rad, Downward surface is left out where every camera sees it flatter than this, or not at all: a number in [0.17, 1.5707963267948966]. Under a hem. The default is 80 degrees
        """
    @grazing_angle.setter
    def grazing_angle(self, value: float) -> None:
        ...
    @property
    def max_missing_views(self) -> int:
        """
        cameras, Number of cameras that may miss a point which all others see: a number in [0, 7]. Silhouettes with holes cut less, and the hull gets thicker
        """
    @max_missing_views.setter
    def max_missing_views(self, value: int) -> None:
        ...
    @property
    def patch(self) -> float:
        """
        m, Side of the square of surface that two cameras compare: a number in [0.01, 0.3]
        """
    @patch.setter
    def patch(self, value: float) -> None:
        ...
    @property
    def poisson_depth(self) -> int:
        """
        Octree depth of the surface through the samples: a number in [5, 11]
        """
    @poisson_depth.setter
    def poisson_depth(self, value: int) -> None:
        ...
    @property
    def search_depth(self) -> float:
        """
        m, Depth inside the hull within which the surface is sought; 0 = the hull itself: a number in [0, 0.3]
        """
    @search_depth.setter
    def search_depth(self, value: float) -> None:
        ...
    @property
    def smoothness(self) -> float:
        """
        Correlation that a step of a centimetre between neighbours must gain: a number above 0
        """
    @smoothness.setter
    def smoothness(self, value: float) -> None:
        ...
class AlignedScan:
    """
    A scan in the world of the cameras, and what was found out about it.
    """
    @property
    def distance(self) -> float:
        """
        m to the hull, mean over the nearest four fifths
        """
    @property
    def floor(self) -> bool:
        """
        the person stood on one
        """
    @property
    def mesh(self) -> Mesh:
        """
        m, +Y up; without floor, specks and surroundings
        """
    @property
    def unit(self) -> str:
        """
        of the scan: 'm', 'cm', 'mm' or 'inches'
        """
    @property
    def up(self) -> str:
        """
        its axis that points up: '+x' ... '-z'
        """
class RestPoseOptions:
    """
    Options of refine_rest_pose.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> RestPoseOptions:
        ...
    def __deepcopy__(self, memo: dict) -> RestPoseOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, frames: int = 8, max_bend: float = 0.2617993877991494, smoothing: float = 0.015, fade_distance: float = 0.05) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def fade_distance(self) -> float:
        """
        m, Distance over which the correction of skin fades out in the cloth beside it: a number in [0.001, 1]. Cloth itself is not corrected
        """
    @fade_distance.setter
    def fade_distance(self, value: float) -> None:
        ...
    @property
    def frames(self) -> int:
        """
        Number of least bent frames of which the median place of a vertex is taken: a number in [1, 1000]
        """
    @frames.setter
    def frames(self, value: int) -> None:
        ...
    @property
    def max_bend(self) -> float:
        """
        rad, Frames tell nothing of a vertex whose joints are bent more, on average by skin weight: a number in [0, 3.141592653589793]. The default is 15 degrees
        """
    @max_bend.setter
    def max_bend(self, value: float) -> None:
        ...
    @property
    def smoothing(self) -> float:
        """
        m, Detail of the correction that is smaller than this is taken for noise: a number in [0.001, 0.1]
        """
    @smoothing.setter
    def smoothing(self, value: float) -> None:
        ...
class SessionCheck:
    """
    What is wrong with a session, and the frame of C cameras that it was looked at in.
    """
    @property
    def findings(self) -> list[Finding]:
        """
        Findings, in the order of the checks
        """
    @property
    def frame(self) -> int:
        """
        that was looked at
        """
    @property
    def joints(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (J, 3) m, placed as the scan is
        """
    @property
    def overlaps(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (C, C) IoU of the silhouette of camera i with the shadow in camera j, or NaN; (0, 0) without a scan
        """
    @property
    def rig(self) -> list[Camera]:
        """
        (C) the cameras made small
        """
    @property
    def shadows(self) -> list[numpy.typing.NDArray[numpy.uint8]]:
        """
        (C) the same of the scan; empty without one
        """
    @property
    def silhouettes(self) -> list[numpy.typing.NDArray[numpy.uint8]]:
        """
        (C) masks (h, w), 255 = actor; (0, 0) = none
        """
    @property
    def start(self) -> StartFrame | None:
        """
        StartFrame, if the scan does not fit frame 0 as it stands; or None
        """
    @property
    def start_text(self) -> str:
        """
        the same in words; may be empty
        """
class TemplateOptions:
    """
    Options of build_template.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> TemplateOptions:
        ...
    def __deepcopy__(self, memo: dict) -> TemplateOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, triangles: int = 5000, high_triangles: int = 25000, poisson_depth: int = 9, hole_gap: float = 0.004, density_drop: float = 0.5, narrow_hole: float = 0.03, large_hole: float = 0.025, sheet_hole: float = 0.005) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def density_drop(self) -> float:
        """
        octree levels, A point lies over a hole if the scan is also this much sparser there than usual: a number of at least 0. One level is a quarter of the samples
        """
    @density_drop.setter
    def density_drop(self, value: float) -> None:
        ...
    @property
    def high_triangles(self) -> int:
        """
        Number of triangles of the display surface M_high, at least as many as of M: a number of at least 100
        """
    @high_triangles.setter
    def high_triangles(self, value: int) -> None:
        ...
    @property
    def hole_gap(self) -> float:
        """
        m, A reconstructed point lies over a hole if it is farther than this from the scan's surface: a number above 0. A scan is good to 1 or 2 mm
        """
    @hole_gap.setter
    def hole_gap(self, value: float) -> None:
        ...
    @property
    def large_hole(self) -> float:
        """
        m^2, Holes from this size on are suggested as invalid: a number above 0. More than a foot's sole, which is rightly closed
        """
    @large_hole.setter
    def large_hole(self, value: float) -> None:
        ...
    @property
    def narrow_hole(self) -> float:
        """
        m, Narrower folds that run into the hem unseen stay valid: a number of at least 0
        """
    @narrow_hole.setter
    def narrow_hole(self, value: float) -> None:
        ...
    @property
    def poisson_depth(self) -> int:
        """
        Octree depth of the Poisson reconstruction: a number in [4, 12]. 9 = cells of 3.6 mm for a person
        """
    @poisson_depth.setter
    def poisson_depth(self, value: int) -> None:
        ...
    @property
    def sheet_hole(self) -> float:
        """
        m^2, Holes with two borders or more are suggested as invalid from this size on: a number above 0. Garment and limb: a closing surface at a hem
        """
    @sheet_hole.setter
    def sheet_hole(self, value: float) -> None:
        ...
    @property
    def triangles(self) -> int:
        """
        Number of triangles of the template M: a number of at least 100. As in the paper
        """
    @triangles.setter
    def triangles(self, value: int) -> None:
        ...
class HeatWeightOptions:
    """
    Options of heat_weights.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> HeatWeightOptions:
        ...
    def __deepcopy__(self, memo: dict) -> HeatWeightOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, c: float = 1.0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def c(self) -> float:
        """
        Heat c of the nearest visible bones, H_ii = c / d^2 (Baran & Popovic 2007): a number above 0
        """
    @c.setter
    def c(self, value: float) -> None:
        ...
class Template:
    """
    The closed surface of a scan, its two decimations and the invented faces.
    """
    def __init__(self) -> None:
        ...
    @property
    def face_valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (F) 0 = suggested as invented over a large hole
        """
    @face_valid.setter
    def face_valid(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def high(self) -> Mesh:
        """
        M_high, what is displayed
        """
    @high.setter
    def high(self, value: Mesh) -> None:
        ...
    @property
    def high_face_valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (FH) the same of M_high
        """
    @high_face_valid.setter
    def high_face_valid(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def mesh(self) -> Mesh:
        """
        M, what is tracked and simulated
        """
    @mesh.setter
    def mesh(self, value: Mesh) -> None:
        ...
class SurfaceQuality:
    """
    What can disappoint about a surface of the template.
    """
    @property
    def first_centile_angle(self) -> float:
        """
        degrees, 1 % of the triangles have a smaller one
        """
    @property
    def invalid_area(self) -> float:
        """
        m^2
        """
    @property
    def max_to_scan(self) -> float:
        """
        m, the largest of them
        """
    @property
    def mean_to_scan(self) -> float:
        """
        m, distance of the valid surface to the scan
        """
    @property
    def scan_max(self) -> float:
        """
        m, the largest of them
        """
    @property
    def scan_mean(self) -> float:
        """
        m, distance of the scan's vertices to the surface
        """
    @property
    def self_intersections(self) -> int:
        """
        triangles that pass through another one
        """
    @property
    def smallest_angle(self) -> float:
        """
        degrees, over all triangles
        """
    @property
    def triangles(self) -> int:
        """
        of the surface
        """
class TemplateSummary:
    """
    Quality of both surfaces of a template.
    """
    @property
    def high(self) -> SurfaceQuality:
        """
        SurfaceQuality of M_high
        """
    @property
    def mesh(self) -> SurfaceQuality:
        """
        SurfaceQuality of M
        """
class FeatureTrackerOptions:
    """
    Options of the SIFT feature tracker.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> FeatureTrackerOptions:
        ...
    def __deepcopy__(self, memo: dict) -> FeatureTrackerOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, budget: int = 500, erode: int = 3, ratio: float = 0.8, max_displacement: float = 0.1) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def budget(self) -> int:
        """
        Number of the strongest features that are kept in an image: a number of at least 1. Time is proportional, 40 to 60 ms an image of 1004 x 1004; 500 do for the pose
        """
    @budget.setter
    def budget(self, value: int) -> None:
        ...
    @property
    def erode(self) -> int:
        """
        px, Features closer to the silhouette are dropped, at 1004 px image height: a number of at least 0. They see background
        """
    @erode.setter
    def erode(self, value: int) -> None:
        ...
    @property
    def max_displacement(self) -> float:
        """
        Largest displacement between two frames, as a share of the silhouette's height: a number above 0. 0.1 = 7 m/s for a person at 40 fps
        """
    @max_displacement.setter
    def max_displacement(self, value: float) -> None:
        ...
    @property
    def ratio(self) -> float:
        """
        Ratio of the best to the second best descriptor distance, at most (Lowe 2004, Sect. 7.1): a number in (0, 1]
        """
    @ratio.setter
    def ratio(self, value: float) -> None:
        ...
class Features:
    """
    Features of one image.
    """
    def __init__(self, points: typing.Annotated[numpy.typing.ArrayLike, numpy.float32, "[m, 2]"], descriptors: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
    @property
    def descriptors(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, C); closeness is Euclidean distance
        """
    @property
    def points(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, 2]"]:
        """
        (N, 2) pixels
        """
class FeatureTracker:
    """
    Swap point: image -> features, features -> matches.
    """
    @staticmethod
    def create(options: FeatureTrackerOptions = ...) -> FeatureTracker:
        """
        The built-in tracker (SIFT).
        """
    def __init__(self) -> None:
        ...
    def detect(self, image: numpy.typing.NDArray[numpy.uint8], mask: numpy.typing.NDArray[numpy.uint8]) -> Features:
        """
        Features of an image (H, W, 3) inside its mask (H, W). Called from many threads.
        """
    def match(self, previous: Features, current: Features, reach: float) -> list[tuple[int, int]]:
        """
        Pairs (index in previous, index in current) no farther apart than `reach` pixels. Called from many threads.
        """
class Outline:
    """
    Boundary of a mask, N points.
    """
    @property
    def normals(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, 2]"]:
        """
        (N, 2) unit, out of the mask
        """
    @property
    def points(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], "[m, 2]"]:
        """
        (N, 2) pixels
        """
class SurfaceTrack:
    """
    A surface point and the pixel where it is seen.
    """
    @property
    def barycentric(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) of that face's corners
        """
    @property
    def face(self) -> int:
        """
        of the surface
        """
    @property
    def pixel(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"]:
        """
        (2) where the point is seen
        """
    @property
    def view(self) -> int:
        """
        camera
        """
    @property
    def weight(self) -> float:
        """
        against the other tracks
        """
class PoseProblem:
    """
    What one frame says about the pose. Lives as long as the call it was given to.
    """
    @property
    def actor(self) -> RiggedMesh:
        """
        a copy
        """
    @property
    def first(self) -> bool:
        """
        nothing is known yet
        """
    @property
    def offset(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m, rest pose, carried over from the frame before
        """
    @property
    def outlines(self) -> list[Outline]:
        """
        measured, one a camera; empty = no part
        """
    @property
    def predicted(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D)
        """
    @property
    def reliability(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) in [0, 1], low on loose cloth
        """
    @property
    def rig(self) -> list[Camera]:
        """
        cameras
        """
    @property
    def start(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D)
        """
    @property
    def tracks(self) -> list[SurfaceTrack]:
        """
        SurfaceTracks: points of the surface and where they are seen
        """
class SurfaceProblem:
    """
    What one frame says about the surface. Lives as long as the call.
    """
    @property
    def actor(self) -> RiggedMesh:
        """
        a copy
        """
    @property
    def base(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m, the surface expected
        """
    @property
    def outlines(self) -> list[Outline]:
        """
        measured, one a camera; empty = no part
        """
    @property
    def reliability(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) in [0, 1], low on loose cloth
        """
    @property
    def rig(self) -> list[Camera]:
        """
        cameras
        """
    @property
    def skinned(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m, posed without any offset
        """
    @property
    def tracks(self) -> list[SurfaceTrack]:
        """
        SurfaceTracks: points of the surface and where they are seen
        """
class PoseOptions:
    """
    Options of the pose optimiser.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> PoseOptions:
        ...
    def __deepcopy__(self, memo: dict) -> PoseOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, iterations: int = 8, first_iterations: int = 24, raster_size: int = 512, rims_per_view: int = 300, gate_start: float = 0.15, gate_end: float = 0.06, scale_start: float = 0.05, scale_end: float = 0.015, sift_weight: float = 1.0, prior_weight: float = 4.0, prior_angle: float = 0.15, prior_shift: float = 0.03, limit_weight: float = 400.0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def first_iterations(self) -> int:
        """
        Number of renderings for the first frame: a number of at least 1
        """
    @first_iterations.setter
    def first_iterations(self, value: int) -> None:
        ...
    @property
    def gate_end(self) -> float:
        """
        m, Rim matches farther away are dropped in the last iteration: a number above 0
        """
    @gate_end.setter
    def gate_end(self, value: float) -> None:
        ...
    @property
    def gate_start(self) -> float:
        """
        m, Rim matches farther away are dropped in the first iteration: a number above 0
        """
    @gate_start.setter
    def gate_start(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of renderings, each with new matches: a number of at least 1. A tracked frame moves by less than 1 mm after 6
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def limit_weight(self) -> float:
        """
        Weight of a joint limit that is passed by prior_angle, against one rim match: a number of at least 0
        """
    @limit_weight.setter
    def limit_weight(self, value: float) -> None:
        ...
    @property
    def prior_angle(self) -> float:
        """
        rad, Expected error of the predicted angles: a number above 0
        """
    @prior_angle.setter
    def prior_angle(self, value: float) -> None:
        ...
    @property
    def prior_shift(self) -> float:
        """
        m, Expected error of the root's predicted translation: a number above 0
        """
    @prior_shift.setter
    def prior_shift(self, value: float) -> None:
        ...
    @property
    def prior_weight(self) -> float:
        """
        Weight of the prediction against one rim match, at a deviation of prior_angle or prior_shift: a number of at least 0
        """
    @prior_weight.setter
    def prior_weight(self, value: float) -> None:
        ...
    @property
    def raster_size(self) -> int:
        """
        px, Longest side of the renderings in which rims are found: a number of at least 64. Rims keep sub-pixel residuals
        """
    @raster_size.setter
    def raster_size(self, value: int) -> None:
        ...
    @property
    def rims_per_view(self) -> int:
        """
        Number of correspondences a view and direction: a number of at least 10
        """
    @rims_per_view.setter
    def rims_per_view(self, value: int) -> None:
        ...
    @property
    def scale_end(self) -> float:
        """
        m, Geman-McClure scale of all residuals in the last iteration: a number above 0. The size of skinning errors
        """
    @scale_end.setter
    def scale_end(self, value: float) -> None:
        ...
    @property
    def scale_start(self) -> float:
        """
        m, Geman-McClure scale of all residuals in the first iteration: a number above 0
        """
    @scale_start.setter
    def scale_start(self, value: float) -> None:
        ...
    @property
    def sift_weight(self) -> float:
        """
        Weight of a feature track against one rim match: a number of at least 0. At 5 a skirt's features, bound to the thigh, held a leg back
        """
    @sift_weight.setter
    def sift_weight(self, value: float) -> None:
        ...
class PoseEstimate:
    """
    A pose and how well it explains its frame.
    """
    def __init__(self) -> None:
        ...
    @property
    def dofs(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D)
        """
    @dofs.setter
    def dofs(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def energy(self) -> float:
        """
        robust mean, in [0, 1]
        """
    @energy.setter
    def energy(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        that were made
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def rim_px(self) -> float:
        """
        mean residual of the outlines, pixels
        """
    @rim_px.setter
    def rim_px(self, value: float) -> None:
        ...
    @property
    def sift_px(self) -> float:
        """
        mean residual of the features, pixels
        """
    @sift_px.setter
    def sift_px(self, value: float) -> None:
        ...
class PoseOptimizer:
    """
    Swap point: one frame's correspondences -> pose.
    """
    @staticmethod
    def create(options: PoseOptions = ...) -> PoseOptimizer:
        """
        The built-in optimiser (Gauss-Newton on rims and tracks).
        """
    def __init__(self) -> None:
        ...
    def optimize(self, problem: PoseProblem, context: Context = ...) -> PoseEstimate:
        """
        The pose that explains the problem best.
        """
class ParticleAnnealingOptions:
    """
    Options of the interacting simulated annealing of lost limbs.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> ParticleAnnealingOptions:
        ...
    def __deepcopy__(self, memo: dict) -> ParticleAnnealingOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, particles: int = 100, iterations: int = 10, coldness: float = 10.0, power: float = 0.7, covariance_share: float = 0.4, seed: int = 1) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def coldness(self) -> float:
        """
        Scale of the schedule, beta_t = coldness (t + 1)^power: a number above 0. A difference in energy of 1 / beta_t makes a particle e times rarer
        """
    @coldness.setter
    def coldness(self, value: float) -> None:
        ...
    @property
    def covariance_share(self) -> float:
        """
        Share of the particles' covariance with which they move after a selection (ibid., alpha): a number in (0, 1]
        """
    @covariance_share.setter
    def covariance_share(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of selections and moves: a number of at least 1. 100 particles and 10 iterations take 0.5 s a lost limb
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def particles(self) -> int:
        """
        Number of particles, which is that of the energies in an iteration: a number of at least 2
        """
    @particles.setter
    def particles(self, value: int) -> None:
        ...
    @property
    def power(self) -> float:
        """
        Power of the schedule (Gall et al. 2007, Sect. 5.2): a number of at least 0
        """
    @power.setter
    def power(self, value: float) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the random numbers: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
class LimbSearchOptions:
    """
    Options of the search for lost limbs.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> LimbSearchOptions:
        ...
    def __deepcopy__(self, memo: dict) -> LimbSearchOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, raster_size: int = 160, lost_error: float = 0.02, max_error: float = 0.3, deviation: float = 0.7, smoothness: float = 0.02, annealing: ParticleAnnealingOptions = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def annealing(self) -> ParticleAnnealingOptions:
        """
        Options of the particles
        """
    @annealing.setter
    def annealing(self, value: ParticleAnnealingOptions) -> None:
        ...
    @property
    def deviation(self) -> float:
        """
        rad, Standard deviation of the first particles around the prediction: a number above 0
        """
    @deviation.setter
    def deviation(self, value: float) -> None:
        ...
    @property
    def lost_error(self) -> float:
        """
        m, A limb with a larger error is lost: a number above 0. Tracked limbs have a few mm, an arm 30 degrees off has 4 cm
        """
    @lost_error.setter
    def lost_error(self, value: float) -> None:
        ...
    @property
    def max_error(self) -> float:
        """
        m, A pixel's disagreement counts at most so much: a number above 0
        """
    @max_error.setter
    def max_error(self, value: float) -> None:
        ...
    @property
    def raster_size(self) -> int:
        """
        px, Longest side of the masks and renderings that are compared: a number of at least 64. An arm is 3 to 4 px wide
        """
    @raster_size.setter
    def raster_size(self, value: int) -> None:
        ...
    @property
    def smoothness(self) -> float:
        """
        Weight of (angle - prediction)^2 / deviation^2 against the share of the limb's area: a number of at least 0
        """
    @smoothness.setter
    def smoothness(self, value: float) -> None:
        ...
class Limb:
    """
    A chain of the skeleton between two forks, or from a fork to an end.
    """
    @property
    def dofs(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        indices
        """
    @property
    def joints(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        indices, parents first
        """
    @property
    def name(self) -> str:
        """
        of its first joint
        """
class LimbProblem:
    """
    A frame in which limbs were lost. Lives as long as the call it was given to.
    """
    @property
    def actor(self) -> RiggedMesh:
        """
        a copy
        """
    @property
    def masks(self) -> list[numpy.typing.NDArray[numpy.uint8]]:
        """
        measured, one a camera; empty = no part
        """
    @property
    def offset(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m, rest pose, carried over from the frame before
        """
    @property
    def predicted(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D)
        """
    @property
    def reliability(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) in [0, 1], low on loose cloth
        """
    @property
    def rig(self) -> list[Camera]:
        """
        cameras
        """
class LimbSearch:
    """
    Swap point: a pose with lost limbs -> a better one.
    """
    @staticmethod
    def create(options: LimbSearchOptions = ...) -> LimbSearch:
        """
        The built-in search (interacting simulated annealing).
        """
    def __init__(self) -> None:
        ...
    def search(self, problem: LimbProblem, dofs: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], lost: collections.abc.Sequence[Limb], context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D) the pose `dofs` with the lost limbs sought anew.
        """
class SurfaceOptions:
    """
    Options of the surface refiner.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> SurfaceOptions:
        ...
    def __deepcopy__(self, memo: dict) -> SurfaceOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, iterations: int = 3, raster_size: int = 1024, rims_per_view: int = 500, gate_start: float = 0.1, gate_end: float = 0.04, scale_start: float = 0.04, scale_end: float = 0.02, sift_weight: float = 2.0, bending: float = 1.0, stretching: float = 0.02, offset_prior_share: float = 1.0, anchor_cloth: float = 0.01, anchor_rigid: float = 0.5, anchor_falloff: float = 0.02) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def anchor_cloth(self) -> float:
        """
        Weight of a cloth vertex's expected position, against one rim match: a number above 0
        """
    @anchor_cloth.setter
    def anchor_cloth(self, value: float) -> None:
        ...
    @property
    def anchor_falloff(self) -> float:
        """
        m, At this distance from its skinned position a vertex has a quarter of anchor_rigid: a number above 0
        """
    @anchor_falloff.setter
    def anchor_falloff(self, value: float) -> None:
        ...
    @property
    def anchor_rigid(self) -> float:
        """
        Weight of a rigid vertex's skinned position, against one rim match: a number above 0
        """
    @anchor_rigid.setter
    def anchor_rigid(self, value: float) -> None:
        ...
    @property
    def bending(self) -> float:
        """
        Weight of |Laplacian of the displacement|^2 a vertex: a number above 0. Keeps the shape between constraints
        """
    @bending.setter
    def bending(self, value: float) -> None:
        ...
    @property
    def gate_end(self) -> float:
        """
        m, Rim matches farther away are dropped in the last iteration: a number above 0
        """
    @gate_end.setter
    def gate_end(self, value: float) -> None:
        ...
    @property
    def gate_start(self) -> float:
        """
        m, Rim matches farther away are dropped in the first iteration: a number above 0. A hem moves up to 0.1 m between frames
        """
    @gate_start.setter
    def gate_start(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of renderings, each with new matches: a number of at least 0
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def offset_prior_share(self) -> float:
        """
        Share of the offset from the skinned surface that bends and stretches back: a number in [0, 1]. 0 lets folds pile up
        """
    @offset_prior_share.setter
    def offset_prior_share(self, value: float) -> None:
        ...
    @property
    def raster_size(self) -> int:
        """
        px, Longest side of the renderings in which rims are found: a number of at least 64
        """
    @raster_size.setter
    def raster_size(self, value: int) -> None:
        ...
    @property
    def rims_per_view(self) -> int:
        """
        Number of correspondences a view and direction: a number of at least 10
        """
    @rims_per_view.setter
    def rims_per_view(self, value: int) -> None:
        ...
    @property
    def scale_end(self) -> float:
        """
        m, Geman-McClure scale of the residuals in the last iteration: a number above 0
        """
    @scale_end.setter
    def scale_end(self, value: float) -> None:
        ...
    @property
    def scale_start(self) -> float:
        """
        m, Geman-McClure scale of the residuals in the first iteration: a number above 0
        """
    @scale_start.setter
    def scale_start(self, value: float) -> None:
        ...
    @property
    def sift_weight(self) -> float:
        """
        Weight of a feature track against one rim match: a number of at least 0. At 10 skin slides after tracks that are off by a pixel
        """
    @sift_weight.setter
    def sift_weight(self, value: float) -> None:
        ...
    @property
    def stretching(self) -> float:
        """
        Weight of |difference of neighbours' displacement|^2: a number above 0. Small; ties down what nothing else does
        """
    @stretching.setter
    def stretching(self, value: float) -> None:
        ...
class SurfaceEstimate:
    """
    A surface and how well it explains its frame.
    """
    def __init__(self) -> None:
        ...
    @property
    def rim_px(self) -> float:
        """
        mean residual of the outlines, pixels
        """
    @rim_px.setter
    def rim_px(self, value: float) -> None:
        ...
    @property
    def sift_px(self) -> float:
        """
        mean residual of the features, pixels
        """
    @sift_px.setter
    def sift_px(self, value: float) -> None:
        ...
    @property
    def vertices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
    @vertices.setter
    def vertices(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
class SurfaceRefiner:
    """
    Swap point: posed surface and correspondences -> surface.
    """
    @staticmethod
    def create(options: SurfaceOptions = ...) -> SurfaceRefiner:
        """
        The built-in refiner (Laplacian deformation).
        """
    def __init__(self) -> None:
        ...
    def refine(self, problem: SurfaceProblem, context: Context = ...) -> SurfaceEstimate:
        """
        The surface that explains the problem best.
        """
class CalibrationRefinementOptions:
    """
    Options of the refinement of the cameras.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> CalibrationRefinementOptions:
        ...
    def __deepcopy__(self, memo: dict) -> CalibrationRefinementOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, moments: int = 20, iterations: int = 20, rims_per_view: int = 300, raster_size: int = 512, rotation: float = 0.008726646259971648, position: float = 0.01, focal: float = 0.005, distortion: float = 0.01, late: float = 1.0, min_change: float = 0.0025) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def distortion(self) -> float:
        """
        Expected error of the first distortion term, of lenses that have any; 0 = it stays: a number of at least 0
        """
    @distortion.setter
    def distortion(self, value: float) -> None:
        ...
    @property
    def focal(self) -> float:
        """
        Expected error of a focal length, as a share of it: a number above 0
        """
    @focal.setter
    def focal(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of renderings, each with new matches: a number of at least 1
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def late(self) -> float:
        """
        frames, Expected delay of a camera against the others; 0 = there is none: a number of at least 0
        """
    @late.setter
    def late(self, value: float) -> None:
        ...
    @property
    def min_change(self) -> float:
        """
        m, Cameras stay as they are if the actor would move by less, in the mean of all: a number of at least 0
        """
    @min_change.setter
    def min_change(self, value: float) -> None:
        ...
    @property
    def moments(self) -> int:
        """
        Number of frames that are used, spread evenly over the take: a number of at least 1
        """
    @moments.setter
    def moments(self, value: int) -> None:
        ...
    @property
    def position(self) -> float:
        """
        m, Expected error of a camera's position, on each axis: a number above 0
        """
    @position.setter
    def position(self, value: float) -> None:
        ...
    @property
    def raster_size(self) -> int:
        """
        px, Longest side of the renderings in which rims are found: a number of at least 64
        """
    @raster_size.setter
    def raster_size(self, value: int) -> None:
        ...
    @property
    def rims_per_view(self) -> int:
        """
        Number of correspondences a view and direction: a number of at least 10
        """
    @rims_per_view.setter
    def rims_per_view(self, value: int) -> None:
        ...
    @property
    def rotation(self) -> float:
        """
        rad, Expected error of a camera's direction: a number in (0, 0.1]. The default is half a degree
        """
    @rotation.setter
    def rotation(self, value: float) -> None:
        ...
class CaptureParts:
    """
    The pieces of a capture; None = the built-in one, made from the options.
    """
    def __init__(self, features: typing.Any = None, pose: typing.Any = None, limbs: typing.Any = None, surface: typing.Any = None) -> None:
        ...
    @property
    def features(self) -> typing.Any:
        """
        an object of that interface; None = the built-in one
        """
    @features.setter
    def features(self, value: typing.Any) -> None:
        ...
    @property
    def limbs(self) -> typing.Any:
        """
        an object of that interface; None = the built-in one
        """
    @limbs.setter
    def limbs(self, value: typing.Any) -> None:
        ...
    @property
    def pose(self) -> typing.Any:
        """
        an object of that interface; None = the built-in one
        """
    @pose.setter
    def pose(self, value: typing.Any) -> None:
        ...
    @property
    def surface(self) -> typing.Any:
        """
        an object of that interface; None = the built-in one
        """
    @surface.setter
    def surface(self, value: typing.Any) -> None:
        ...
class CaptureOptions:
    """
    Options of PerformanceCapture.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> CaptureOptions:
        ...
    def __deepcopy__(self, memo: dict) -> CaptureOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, first_frame: int = 0, frame_count: int = -1, start_frame: int = -1, cameras: collections.abc.Sequence[str] = ..., use_sift: bool = True, features: FeatureTrackerOptions = ..., pose: PoseOptions = ..., limbs: LimbSearchOptions = ..., surface: SurfaceOptions = ..., refine_cameras: bool = True, calibration: CalibrationRefinementOptions = ..., find_lost_limbs: bool = True, extra_twist_range: float = 0.8, second_pass: bool = True, use_feature_map: bool = True, map_search_radius: float = 0.05, velocity_damping: float = 0.8, acceleration: float = 0.3, offset_decay: float = 0.95, cloth_deviation_scale: float = 0.01, smooth_window: int = 5, smooth_order: int = 2, checkpoint: os.PathLike | str | bytes = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def acceleration(self) -> float:
        """
        Share of the last change of velocity that is expected again: a number in [0, 1]
        """
    @acceleration.setter
    def acceleration(self, value: float) -> None:
        ...
    @property
    def calibration(self) -> CalibrationRefinementOptions:
        """
        Options of the refinement of the cameras
        """
    @calibration.setter
    def calibration(self, value: CalibrationRefinementOptions) -> None:
        ...
    @property
    def cameras(self) -> list[str]:
        """
        Names of the cameras to use; none = all
        """
    @cameras.setter
    def cameras(self, value: collections.abc.Sequence[str]) -> None:
        ...
    @property
    def checkpoint(self) -> pathlib.Path:
        """
        a file that a capture which was stopped goes on from, to the same bits; empty = none
        """
    @checkpoint.setter
    def checkpoint(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def cloth_deviation_scale(self) -> float:
        """
        m, A vertex that usually lies this far from its skinned position has half the weight in the pose: a number above 0
        """
    @cloth_deviation_scale.setter
    def cloth_deviation_scale(self, value: float) -> None:
        ...
    @property
    def extra_twist_range(self) -> float:
        """
        rad, The last joint of a limb may turn about the bone before it by this, each way; 0 = not at all: a number of at least 0. A foot turns in and out, which the session's hinge does not know; else the whole leg turns with it
        """
    @extra_twist_range.setter
    def extra_twist_range(self, value: float) -> None:
        ...
    @property
    def features(self) -> FeatureTrackerOptions:
        """
        Options of the feature tracker
        """
    @features.setter
    def features(self, value: FeatureTrackerOptions) -> None:
        ...
    @property
    def find_lost_limbs(self) -> bool:
        """
        Limbs that the local optimisation has lost are searched for globally
        """
    @find_lost_limbs.setter
    def find_lost_limbs(self, value: bool) -> None:
        ...
    @property
    def first_frame(self) -> int:
        """
        First video frame: a number of at least 0
        """
    @first_frame.setter
    def first_frame(self, value: int) -> None:
        ...
    @property
    def frame_count(self) -> int:
        """
        Number of frames; -1 = to the end: a number of at least -1
        """
    @frame_count.setter
    def frame_count(self, value: int) -> None:
        ...
    @property
    def limbs(self) -> LimbSearchOptions:
        """
        Options of the search for lost limbs
        """
    @limbs.setter
    def limbs(self, value: LimbSearchOptions) -> None:
        ...
    @property
    def map_search_radius(self) -> float:
        """
        Distance within which a mapped feature is sought, as a share of the silhouette's height: a number above 0
        """
    @map_search_radius.setter
    def map_search_radius(self, value: float) -> None:
        ...
    @property
    def offset_decay(self) -> float:
        """
        Share of the non-rigid offset that is expected again in the next frame: a number in [0, 1]
        """
    @offset_decay.setter
    def offset_decay(self, value: float) -> None:
        ...
    @property
    def pose(self) -> PoseOptions:
        """
        Options of the pose optimiser
        """
    @pose.setter
    def pose(self, value: PoseOptions) -> None:
        ...
    @property
    def refine_cameras(self) -> bool:
        """
        Calibration and delays are mended where the take shows that they are clearly off
        """
    @refine_cameras.setter
    def refine_cameras(self, value: bool) -> None:
        ...
    @property
    def second_pass(self) -> bool:
        """
        Everything is tracked a second time, when it is known which vertices are loose cloth
        """
    @second_pass.setter
    def second_pass(self, value: bool) -> None:
        ...
    @property
    def smooth_order(self) -> int:
        """
        Order of the Savitzky-Golay filter: a number of at least 0
        """
    @smooth_order.setter
    def smooth_order(self, value: int) -> None:
        ...
    @property
    def smooth_window(self) -> int:
        """
        Frames of the Savitzky-Golay filter of pose and offsets, an odd number; 1 = off: a number of at least 1
        """
    @smooth_window.setter
    def smooth_window(self, value: int) -> None:
        ...
    @property
    def start_frame(self) -> int:
        """
        Video frame from which tracking goes both ways; -1 = the first, or the one most like the scan: a number of at least -1. The first if it is in the scan's pose, or else the frame that comes nearest to it
        """
    @start_frame.setter
    def start_frame(self, value: int) -> None:
        ...
    @property
    def surface(self) -> SurfaceOptions:
        """
        Options of the surface refiner
        """
    @surface.setter
    def surface(self, value: SurfaceOptions) -> None:
        ...
    @property
    def use_feature_map(self) -> bool:
        """
        Features of the first frame are found again in every frame. Tracks from frame to frame alone drift
        """
    @use_feature_map.setter
    def use_feature_map(self, value: bool) -> None:
        ...
    @property
    def use_sift(self) -> bool:
        """
        Texture features are detected and matched; off = silhouettes alone
        """
    @use_sift.setter
    def use_sift(self, value: bool) -> None:
        ...
    @property
    def velocity_damping(self) -> float:
        """
        Share of the last velocity that is expected again; 0 = stay, 1 = go on as before: a number in [0, 1]. With acceleration 0.3, RMS errors of the prediction on two motions fall from 1.18 and 0.58 degrees to 0.98 and 0.49
        """
    @velocity_damping.setter
    def velocity_damping(self, value: float) -> None:
        ...
class LostLimb:
    """
    A limb that the local optimisation had lost.
    """
    def __init__(self) -> None:
        ...
    @property
    def after(self) -> float:
        """
        m, error of the pose that was kept
        """
    @after.setter
    def after(self, value: float) -> None:
        ...
    @property
    def before(self) -> float:
        """
        m, error after the local optimisation
        """
    @before.setter
    def before(self, value: float) -> None:
        ...
    @property
    def frame(self) -> int:
        """
        video frame number
        """
    @frame.setter
    def frame(self, value: int) -> None:
        ...
    @property
    def limb(self) -> str:
        """
        name of its first joint
        """
    @limb.setter
    def limb(self, value: str) -> None:
        ...
    @property
    def recovered(self) -> bool:
        """
        was it found again?
        """
    @recovered.setter
    def recovered(self, value: bool) -> None:
        ...
class JointVisibility:
    """
    In how many frames a joint's bone was seen, inferred, lost.
    """
    def __init__(self) -> None:
        ...
    @property
    def inferred(self) -> int:
        """
        hidden; it follows from the joints before and after it
        """
    @inferred.setter
    def inferred(self, value: int) -> None:
        ...
    @property
    def joint(self) -> str:
        """
        name of one with degrees of freedom
        """
    @joint.setter
    def joint(self, value: str) -> None:
        ...
    @property
    def lost(self) -> int:
        """
        its limb was lost and not found again
        """
    @lost.setter
    def lost(self, value: int) -> None:
        ...
    @property
    def seen(self) -> int:
        """
        enough of it visible that moves with the skeleton
        """
    @seen.setter
    def seen(self, value: int) -> None:
        ...
class RefinedCamera:
    """
    What a take says about a camera of its calibration.
    """
    def __init__(self) -> None:
        ...
    @property
    def camera(self) -> str:
        """
        its name
        """
    @camera.setter
    def camera(self, value: str) -> None:
        ...
    @property
    def delay(self) -> int:
        """
        whole frames of that which were made good
        """
    @delay.setter
    def delay(self, value: int) -> None:
        ...
    @property
    def focal(self) -> float:
        """
        change as a share
        """
    @focal.setter
    def focal(self, value: float) -> None:
        ...
    @property
    def late(self) -> float:
        """
        frames by which it shows things later than the others
        """
    @late.setter
    def late(self, value: float) -> None:
        ...
    @property
    def late_sure(self) -> float:
        """
        frames, standard deviation of that
        """
    @late_sure.setter
    def late_sure(self, value: float) -> None:
        ...
    @property
    def moved(self) -> float:
        """
        m, how far the actor appears from where the given camera has it, RMS
        """
    @moved.setter
    def moved(self, value: float) -> None:
        ...
    @property
    def seen(self) -> bool:
        """
        the actor was, in some moment
        """
    @seen.setter
    def seen(self, value: bool) -> None:
        ...
    @property
    def shifted(self) -> float:
        """
        m, of the centre
        """
    @shifted.setter
    def shifted(self, value: float) -> None:
        ...
    @property
    def sure(self) -> float:
        """
        m, the standard deviation of that
        """
    @sure.setter
    def sure(self, value: float) -> None:
        ...
    @property
    def turned(self) -> float:
        """
        degrees
        """
    @turned.setter
    def turned(self, value: float) -> None:
        ...
class CaptureSummary:
    """
    What can disappoint about a capture.
    """
    def __init__(self) -> None:
        ...
    @property
    def cameras(self) -> list[RefinedCamera]:
        """
        what the take says about each; none if they were not to be refined
        """
    @cameras.setter
    def cameras(self, value: collections.abc.Sequence[RefinedCamera]) -> None:
        ...
    @property
    def cameras_refined(self) -> bool:
        """
        the performance is of the refined cameras, those of the observations
        """
    @cameras_refined.setter
    def cameras_refined(self, value: bool) -> None:
        ...
    @property
    def jitter_after(self) -> float:
        """
        the same after smoothing
        """
    @jitter_after.setter
    def jitter_after(self, value: float) -> None:
        ...
    @property
    def jitter_before(self) -> float:
        """
        rad, mean |second difference| of the joint angles
        """
    @jitter_before.setter
    def jitter_before(self, value: float) -> None:
        ...
    @property
    def joints(self) -> list[JointVisibility]:
        """
        those with degrees of freedom
        """
    @joints.setter
    def joints(self, value: collections.abc.Sequence[JointVisibility]) -> None:
        ...
    @property
    def limb_seconds(self) -> float:
        """
        s: the check of limbs and the search for lost ones
        """
    @limb_seconds.setter
    def limb_seconds(self, value: float) -> None:
        ...
    @property
    def lost_limbs(self) -> list[LostLimb]:
        """
        in the order of frames
        """
    @lost_limbs.setter
    def lost_limbs(self, value: collections.abc.Sequence[LostLimb]) -> None:
        ...
    @property
    def map_seconds(self) -> float:
        """
        s: features lifted to the surface and found by the map
        """
    @map_seconds.setter
    def map_seconds(self, value: float) -> None:
        ...
    @property
    def measure_seconds(self) -> float:
        """
        s: images to outlines, features and their matches
        """
    @measure_seconds.setter
    def measure_seconds(self, value: float) -> None:
        ...
    @property
    def pose_seconds(self) -> float:
        """
        s: poses
        """
    @pose_seconds.setter
    def pose_seconds(self, value: float) -> None:
        ...
    @property
    def rim_px(self) -> list[float]:
        """
        (T) mean residual of the outlines, pixels
        """
    @rim_px.setter
    def rim_px(self, value: collections.abc.Sequence[float]) -> None:
        ...
    @property
    def seconds_per_frame(self) -> float:
        """
        s, of the whole run
        """
    @seconds_per_frame.setter
    def seconds_per_frame(self, value: float) -> None:
        ...
    @property
    def sift_px(self) -> list[float]:
        """
        (T) mean residual of the features, pixels
        """
    @sift_px.setter
    def sift_px(self, value: collections.abc.Sequence[float]) -> None:
        ...
    @property
    def silhouette_iou(self) -> list[float]:
        """
        (T) mean over cameras, against the measured masks
        """
    @silhouette_iou.setter
    def silhouette_iou(self, value: collections.abc.Sequence[float]) -> None:
        ...
    @property
    def start_frame(self) -> int:
        """
        video frame from which tracking went both ways
        """
    @start_frame.setter
    def start_frame(self, value: int) -> None:
        ...
    @property
    def surface_seconds(self) -> float:
        """
        s: surfaces
        """
    @surface_seconds.setter
    def surface_seconds(self, value: float) -> None:
        ...
    @property
    def views(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        (T) cameras that took part
        """
    @views.setter
    def views(self, value: collections.abc.Sequence[int]) -> None:
        ...
class CaptureResult:
    """
    Performance, observations and summary of a capture.
    """
    def __init__(self) -> None:
        ...
    @property
    def observations(self) -> Observations:
        """
        what was measured in the images
        """
    @observations.setter
    def observations(self, value: Observations) -> None:
        ...
    @property
    def performance(self) -> ReferencePerformance:
        """
        ReferencePerformance
        """
    @performance.setter
    def performance(self, value: ReferencePerformance) -> None:
        ...
    @property
    def summary(self) -> CaptureSummary:
        """
        CaptureSummary
        """
    @summary.setter
    def summary(self, value: CaptureSummary) -> None:
        ...
class PerformanceCapture:
    """
    Stage: video -> reference performance.
    """
    @staticmethod
    def create(options: CaptureOptions = ..., parts: CaptureParts = ...) -> PerformanceCapture:
        """
        The built-in capture, with pieces of one's own in `parts`.
        """
    def __init__(self) -> None:
        ...
    def capture(self, actor: RiggedMesh, rig: collections.abc.Sequence[Camera], frames: FrameSource, extractor: SilhouetteExtractor | None = None, context: Context = ...) -> CaptureResult:
        """
        Tracks all frames. extractor: None if all cameras have masks.
        """
class OppositeOptions:
    """
    The rays by which ClothSegmenter measures.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> OppositeOptions:
        ...
    def __deepcopy__(self, memo: dict) -> OppositeOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, rays: int = 13, cone: float = 0.35, min_distance: float = 0.005, min_cosine: float = 0.5, trim: float = 0.05) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def cone(self) -> float:
        """
        rad, Half angle of the ring of rays: a number in [0, 1.5)
        """
    @cone.setter
    def cone(self, value: float) -> None:
        ...
    @property
    def min_cosine(self) -> float:
        """
        Smallest cosine between ray and outward normal where the ray leaves: a number in [-1, 1). A grazing hit slides along the surface
        """
    @min_cosine.setter
    def min_cosine(self, value: float) -> None:
        ...
    @property
    def min_distance(self) -> float:
        """
        m, Nearer hits do not count: a number of at least 0. They are the vertex's own sheet (a fold), not the opposite side
        """
    @min_distance.setter
    def min_distance(self, value: float) -> None:
        ...
    @property
    def rays(self) -> int:
        """
        Number of rays a vertex: the paper's, along -n, and a ring around it: a number in [1, 64]. The median of their deviations counts
        """
    @rays.setter
    def rays(self, value: int) -> None:
        ...
    @property
    def trim(self) -> float:
        """
        Share of the frames left out at either end of the sorted distances; 0 = the paper's: a number in [0, 0.5). Lost tracking and extreme bends
        """
    @trim.setter
    def trim(self, value: float) -> None:
        ...
class SegmentOptions:
    """
    Options of ClothSegmenter.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> SegmentOptions:
        ...
    def __deepcopy__(self, memo: dict) -> SegmentOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, even_odds: float = 3.0, slope: float = 4.0, colour: float = 4.5, border: float = 0.12, min_region_area: float = 0.08, diffusion: float = 0.03, thresholds: bool = False, rigid_threshold: float = 0.0025, cloth_threshold: float = 0.006, opposite: OppositeOptions = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def border(self) -> float:
        """
        m, Cost of a metre of border, in square metres labelled against log odds of 1: a number of at least 0
        """
    @border.setter
    def border(self, value: float) -> None:
        ...
    @property
    def cloth_threshold(self) -> float:
        """
        m, Threshold t_cloth of eq. 1: above, a vertex is cloth: a number of at least 0
        """
    @cloth_threshold.setter
    def cloth_threshold(self, value: float) -> None:
        ...
    @property
    def colour(self) -> float:
        """
        Weight of the log likelihood ratio of the colours; 0 = motion alone: a number of at least 0. With 0 no video is opened
        """
    @colour.setter
    def colour(self, value: float) -> None:
        ...
    @property
    def diffusion(self) -> float:
        """
        m, Length scale of the diffusion of the clothness: a number of at least 0. Half of it smooths the border of the labels
        """
    @diffusion.setter
    def diffusion(self, value: float) -> None:
        ...
    @property
    def even_odds(self) -> float:
        """
        Deviation of equal odds for cloth and skin, in deviations of the stillest tenth of the surface: a number of at least 1. Captured skin is at 1.5 in the median and below 3 nearly everywhere, loose cloth at 5 and more
        """
    @even_odds.setter
    def even_odds(self, value: float) -> None:
        ...
    @property
    def min_region_area(self) -> float:
        """
        m^2, Garments that touch are told apart by colour if each is at least this large: a number of at least 0. 28 x 28 cm, about a short sleeve
        """
    @min_region_area.setter
    def min_region_area(self, value: float) -> None:
        ...
    @property
    def opposite(self) -> OppositeOptions:
        """
        Options of the rays to the other side
        """
    @opposite.setter
    def opposite(self, value: OppositeOptions) -> None:
        ...
    @property
    def rigid_threshold(self) -> float:
        """
        m, Threshold t_rigid of eq. 1: below, a vertex is rigid: a number of at least 0
        """
    @rigid_threshold.setter
    def rigid_threshold(self, value: float) -> None:
        ...
    @property
    def slope(self) -> float:
        """
        Log odds of cloth that are gained for each factor of e in the deviation: a number of at least 0
        """
    @slope.setter
    def slope(self, value: float) -> None:
        ...
    @property
    def thresholds(self) -> bool:
        """
        Cloth is told by eq. 1 of the paper with its two thresholds; off = by the energy
        """
    @thresholds.setter
    def thresholds(self, value: bool) -> None:
        ...
class SegmentInputs:
    """
    What a ClothSegmenter is given; only the surface is needed.
    """
    def __init__(self, surface: MeshSequence, face_valid: numpy.typing.ArrayLike = [], canonical: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None, colours: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] | None = None, prior: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"] = ...) -> None:
        ...
    @property
    def canonical(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (T, V, 3) m: the frames brought back to the scan pose (canonical_frames), or empty; a copy
        """
    @canonical.setter
    def canonical(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> None:
        ...
    @property
    def colours(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (F k, 3) B G R, 0 to 255, of k points of every face (sample_colours), NaN = unseen; or empty.
        """
    @colours.setter
    def colours(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def face_valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (F) 0 = invented over a large hole; empty = all valid
        """
    @face_valid.setter
    def face_valid(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def prior(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (V) log odds of cloth before anything is seen (cloth_prior); or empty
        """
    @prior.setter
    def prior(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def surface(self) -> MeshSequence:
        """
        MeshSequence as captured; the first frame is in the scan pose
        """
    @surface.setter
    def surface(self, value: MeshSequence) -> None:
        ...
class ClothSegmenter:
    """
    Stage: captured surface -> segmentation. Subclass to replace it.
    """
    @staticmethod
    def create(options: SegmentOptions = ...) -> ClothSegmenter:
        """
        The built-in segmenter (Sect. 5).
        """
    def __init__(self) -> None:
        ...
    def segment(self, inputs: SegmentInputs, context: Context = ...) -> Segmentation:
        """
        Which vertices are loose cloth.
        """
class SegmentSummary:
    """
    What a segmentation found.
    """
    @property
    def cloth_area(self) -> float:
        """
        m^2, clothness over a half
        """
    @property
    def known_fraction(self) -> float:
        """
        of the seen vertices: had a usable opposite ray
        """
    @property
    def noise(self) -> float:
        """
        m, deviation of the stillest tenth of the surface
        """
    @property
    def regions(self) -> int:
        """
        cloth regions
        """
    @property
    def transition_area(self) -> float:
        """
        m^2, clothness of at most a half, but not 0
        """
    @property
    def uncertain_area(self) -> float:
        """
        share with a probability of cloth from 0.1 to 0.9
        """
class GarmentOptions:
    """
    Options of GarmentMesher.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> GarmentOptions:
        ...
    def __deepcopy__(self, memo: dict) -> GarmentOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, remesh: bool = True, vertices: int = 1400, closing_length: float = 0.015, min_hole_area: float = 0.02, min_piece_area: float = 0.08, min_edge_run: float = 0.15, length_exceedances: collections.abc.Sequence[float] = ..., attachment_width: float = 0.0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def attachment_width(self) -> float:
        """
        m, Width of the band across which cloth goes from attached to free; 0 = a seam: a number in [0, 1]
        """
    @attachment_width.setter
    def attachment_width(self, value: float) -> None:
        ...
    @property
    def closing_length(self) -> float:
        """
        m, Length scale of the diffusion that decides what is garment: a number in [0, 1]. Narrower slits are closed, and hems come out smooth
        """
    @closing_length.setter
    def closing_length(self, value: float) -> None:
        ...
    @property
    def length_exceedances(self) -> list[float]:
        """
        Shares of the time in which a length may be exceeded, one a width; more is narrower: a number in (0, 1). The material search answers a width, for the film tells which moves as filmed
        """
    @length_exceedances.setter
    def length_exceedances(self, value: collections.abc.Sequence[float]) -> None:
        ...
    @property
    def min_edge_run(self) -> float:
        """
        m, Shorter changes between attachment and free edge along the cut are ignored: a number in [0, 10]. They are noise of the template's mask
        """
    @min_edge_run.setter
    def min_edge_run(self, value: float) -> None:
        ...
    @property
    def min_hole_area(self) -> float:
        """
        m^2, Smaller holes of the garment are filled: a number in [0, 10]. 14 x 14 cm
        """
    @min_hole_area.setter
    def min_hole_area(self, value: float) -> None:
        ...
    @property
    def min_piece_area(self) -> float:
        """
        m^2, Smaller pieces move as skin: a number in [0, 10]. 28 x 28 cm, about a short sleeve
        """
    @min_piece_area.setter
    def min_piece_area(self, value: float) -> None:
        ...
    @property
    def remesh(self) -> bool:
        """
        Cloth gets a regular mesh of its own; off = it is a part of the template, as in the paper
        """
    @remesh.setter
    def remesh(self, value: bool) -> None:
        ...
    @property
    def vertices(self) -> int:
        """
        Approximate number of vertices of all regions together: a number in [50, 2e+05]. More fold finer and cost more
        """
    @vertices.setter
    def vertices(self, value: int) -> None:
        ...
class GarmentMesher:
    """
    Stage: segmentation -> the garment's mesh. Subclass to replace it.
    """
    @staticmethod
    def create(options: GarmentOptions = ...) -> GarmentMesher:
        """
        The built-in mesher.
        """
    def __init__(self) -> None:
        ...
    def mesh(self, actor: RiggedMesh, segmentation: Segmentation, body: Mesh, captured: MeshSequence, context: Context = ...) -> Garment:
        """
        All cloth as a mesh of its own.
        """
class GarmentSummary:
    """
    What the mesher made.
    """
    @property
    def faces(self) -> int:
        """
        of the garment's mesh
        """
    @property
    def hanging_loops(self) -> int:
        """
        that hang on the skeleton, at least in part
        """
    @property
    def loops(self) -> int:
        """
        boundaries; a skirt has two
        """
    @property
    def mean_edge(self) -> float:
        """
        m
        """
    @property
    def regions(self) -> int:
        """
        cloth regions
        """
    @property
    def smallest_angle(self) -> float:
        """
        degrees, 1 % quantile
        """
    @property
    def vertices(self) -> int:
        """
        of the garment's mesh
        """
class BodyModel:
    """
    vertices = mean + components s, s ~ N(0, I). To replace it, define vertices(coefficients) and component(k) in a subclass; a model that is not linear also linearise(coefficients, chosen), one with a skeleton joints(coefficients).
    """
    @staticmethod
    def read(path: os.PathLike | str | bytes) -> BodyModel:
        """
        A model in this library's format or SMPL's (.npz). Raises FileNotFoundError, or Error naming file and array.
        """
    def __init__(self, *, vertex_count: int, component_count: int, faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], landmarks: collections.abc.Mapping[str, int] = {}, name: str = 'python', shape_count: int | None = None, joint_names: collections.abc.Sequence[str] = []) -> None:
        """
        What a subclass is made of. faces (F, 3); landmarks: name -> vertex; shape_count: the first coefficients, None = all.
        """
    def component(self, k: int) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (B, 3) m per standard deviation
        """
    def joints(self, coefficients: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]:
        """
        The same of the model's own joints, in the order of joint_names.
        """
    def linearise(self, coefficients: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], chosen: collections.abc.Sequence[int]) -> tuple[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"], typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]:
        """
        The chosen vertices (n, 3) m and their derivatives (3n, K) m per standard deviation.
        """
    def vertices(self, coefficients: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (B, 3) m
        """
    @property
    def component_count(self) -> int:
        """
        C, of shape
        """
    @property
    def faces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        (FB, 3)
        """
    @property
    def joint_names(self) -> list[str]:
        """
        of the model's own skeleton; empty = none
        """
    @property
    def landmarks(self) -> dict[str, int]:
        """
        name -> vertex of the body
        """
    @property
    def name(self) -> str:
        """
        name and hash of the file
        """
    @property
    def shape_count(self) -> int:
        """
        the first coefficients; the others are the pose
        """
    @property
    def vertex_count(self) -> int:
        """
        B
        """
class BodyFitOptions:
    """
    Options of BodyFitter.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> BodyFitOptions:
        ...
    def __deepcopy__(self, memo: dict) -> BodyFitOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, iterations: int = 20, landmark_deviation: float = 0.015, joint_deviation: float = 0.025, surface_deviation: float = 0.004, scale_deviation: float = 0.03, outlier_scale: float = 0.01, cloth_margin: float = 0.003, cloth_attraction: float = 0.03) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def cloth_attraction(self) -> float:
        """
        Weight of cloth within about outlier_scale of the body, against that of skin: a number in [0, 1]. Where cloth is that close it rests on the body
        """
    @cloth_attraction.setter
    def cloth_attraction(self, value: float) -> None:
        ...
    @property
    def cloth_margin(self) -> float:
        """
        m, The body stays at least this far inside cloth: a number of at least 0
        """
    @cloth_margin.setter
    def cloth_margin(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of ICP iterations: a number of at least 1. The robust scale shrinks over the first two thirds
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def joint_deviation(self) -> float:
        """
        m, Expected error of a marked joint: a number above 0. Rigs differ in where a hip is
        """
    @joint_deviation.setter
    def joint_deviation(self, value: float) -> None:
        ...
    @property
    def landmark_deviation(self) -> float:
        """
        m, Expected error of a clicked landmark: a number above 0. Cauchy weights count for less what is more than three of them off
        """
    @landmark_deviation.setter
    def landmark_deviation(self, value: float) -> None:
        ...
    @property
    def outlier_scale(self) -> float:
        """
        m, Final scale of the Geman-McClure weights of the surface: a number above 0. Hair and shoes are outliers
        """
    @outlier_scale.setter
    def outlier_scale(self, value: float) -> None:
        ...
    @property
    def scale_deviation(self) -> float:
        """
        Expected relative deviation of the overall scale from 1: a number above 0. Stature is the model's; this is for units and children
        """
    @scale_deviation.setter
    def scale_deviation(self, value: float) -> None:
        ...
    @property
    def surface_deviation(self) -> float:
        """
        m, Expected error of skin around the model, for 4 cm^2 of surface: a number above 0. Errors of the model are correlated
        """
    @surface_deviation.setter
    def surface_deviation(self, value: float) -> None:
        ...
class ProxyOptions:
    """
    Options of fit_proxies.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> ProxyOptions:
        ...
    def __deepcopy__(self, memo: dict) -> ProxyOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, clearance: float = 0.0, cloth_margin: float = 0.004, capsules_per_bone: int = 2, iterations: int = 40) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def capsules_per_bone(self) -> int:
        """
        Number of tapered capsules along one bone: a number in [1, 3]
        """
    @capsules_per_bone.setter
    def capsules_per_bone(self, value: int) -> None:
        ...
    @property
    def clearance(self) -> float:
        """
        m, The capsules are this far inside the body on average: a number in (-0.1, 0.1)
        """
    @clearance.setter
    def clearance(self, value: float) -> None:
        ...
    @property
    def cloth_margin(self) -> float:
        """
        m, The capsules are at least this far inside the cloth of the scan pose: a number in [0, 0.1). Resting cloth is never pushed
        """
    @cloth_margin.setter
    def cloth_margin(self, value: float) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of iterations of the least squares: a number of at least 0
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
class ClothedScan:
    """
    One of several scans of the same person.
    """
    def __init__(self, actor: RiggedMesh, segmentation: Segmentation, landmarks: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]]) -> None:
        ...
    @property
    def actor(self) -> RiggedMesh:
        """
        RiggedMesh in the scan pose
        """
    @property
    def landmarks(self) -> dict[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]]:
        """
        name -> point on the surface, m
        """
    @property
    def segmentation(self) -> Segmentation:
        """
        what of it is cloth
        """
class BodyFitter:
    """
    Stage: dressed surface -> body underneath. Subclass to replace it.
    """
    @staticmethod
    def create(options: BodyFitOptions = ...) -> BodyFitter:
        """
        The built-in fitter.
        """
    def __init__(self) -> None:
        ...
    def fit(self, actor: RiggedMesh, segmentation: Segmentation, model: BodyModel, landmarks: collections.abc.Mapping[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]], context: Context = ...) -> BodyFit:
        """
        The body under the clothes. landmarks: name -> point, m.
        """
    def fit_together(self, scans: collections.abc.Sequence[ClothedScan], model: BodyModel, context: Context = ...) -> list[BodyFit]:
        """
        One shape, a pose a scan; a list of BodyFit.
        """
class DetectedJoints:
    """
    Joints and landmarks of a person that nobody marked.
    """
    @property
    def facing_ambiguity(self) -> float:
        """
        how unlikely it is over the fit that looks the other way: near 1 = hard to tell
        """
    @property
    def fit(self) -> BodyFit:
        """
        the body that they were read from
        """
    @property
    def joints(self) -> list[JointAnnotation]:
        """
        the standard joints, JointAnnotation
        """
    @property
    def landmarks(self) -> dict[str, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]]:
        """
        name -> point on the body, m
        """
class BodyRegion:
    """
    How far a fit can be trusted along one bone.
    """
    @property
    def area(self) -> float:
        """
        m^2 of the body
        """
    @property
    def deviation(self) -> float:
        """
        m, expected RMS error
        """
    @property
    def exposed(self) -> float:
        """
        share of it whose nearest surface is skin
        """
    @property
    def joint(self) -> str:
        """
        that the bone hangs from
        """
    @property
    def residual(self) -> float:
        """
        m, mean distance of that skin to the body
        """
class ProxyStatistics:
    """
    How well the capsules stand for the body under cloth, m.
    """
    @property
    def capsules(self) -> int:
        """
        their number
        """
    @property
    def cloth_clearance(self) -> float:
        """
        m, smallest signed distance of the resting cloth to the capsules; negative = pushed
        """
    @property
    def largest_bulge(self) -> float:
        """
        m, how far a capsule stands out of the body at most; 0 = nowhere
        """
    @property
    def mean_distance(self) -> float:
        """
        m, mean |signed distance| of body vertices under cloth to the union of capsules
        """
    @property
    def percentile95(self) -> float:
        """
        m, 95 % of the same
        """
    @property
    def samples(self) -> int:
        """
        body vertices under cloth
        """
class TrainOptions:
    """
    Options of train_body_model.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> TrainOptions:
        ...
    def __deepcopy__(self, memo: dict) -> TrainOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, components: int = 100, pose_floor: float = 0.07, individuals: collections.abc.Sequence[int] = ..., name: str = 'doublet-body', licence: str = 'CC0 1.0 Universal', command: str = '') -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def command(self) -> str:
        """
        Command that is recorded in the file
        """
    @command.setter
    def command(self, value: str) -> None:
        ...
    @property
    def components(self) -> int:
        """
        Number of shape components that are kept, at most meshes - 1: a number of at least 1. 100 keep 99.99 % of the shipped population's variance
        """
    @components.setter
    def components(self, value: int) -> None:
        ...
    @property
    def individuals(self) -> list[int]:
        """
        Individuals to train on; empty = all: a number of at least 0. The others are for leave-out tests
        """
    @individuals.setter
    def individuals(self, value: collections.abc.Sequence[int]) -> None:
        ...
    @property
    def licence(self) -> str:
        """
        Licence of the population, which is copied into the file
        """
    @licence.setter
    def licence(self, value: str) -> None:
        ...
    @property
    def name(self) -> str:
        """
        Name of the model
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def pose_floor(self) -> float:
        """
        rad, Angle that is added in quadrature to every pose deviation: a number above 0. Joints that the population never bends sideways can then follow a scan a little
        """
    @pose_floor.setter
    def pose_floor(self, value: float) -> None:
        ...
class TrainSummary:
    """
    What a training kept.
    """
    @property
    def components(self) -> int:
        """
        of shape that were kept
        """
    @property
    def meshes(self) -> int:
        """
        of the population
        """
    @property
    def reconstruction_mm(self) -> float:
        """
        mean vertex error of the training set
        """
    @property
    def variance_kept(self) -> float:
        """
        fraction
        """
    @property
    def vertices(self) -> int:
        """
        of each
        """
class Material:
    """
    Material of a piece of cloth; see Material.described() for units and ranges.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def boxes() -> dict:
        """
        Name -> (lower, upper) of every parameter.
        """
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> Material:
        ...
    def __deepcopy__(self, memo: dict) -> Material:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, d_n: float = 4.0, d_t: float = 4.9, k_bend: float = 0.7, k_stretch: float = 1.0, k_friction: float = 0.5, k_damping: float = 0.0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def d_n(self) -> float:
        """
        1/m, Drag along the normal, quadratic in the velocity: a number in [0, 32]
        """
    @d_n.setter
    def d_n(self, value: float) -> None:
        ...
    @property
    def d_t(self) -> float:
        """
        1/s, Drag along the surface, linear in the velocity: a number in [0, 32]
        """
    @d_t.setter
    def d_t(self, value: float) -> None:
        ...
    @property
    def k_bend(self) -> float:
        """
        Bending stiffness, as a share: a number in [0, 1]. In N m: spring_constant()
        """
    @k_bend.setter
    def k_bend(self, value: float) -> None:
        ...
    @property
    def k_damping(self) -> float:
        """
        Damping of the velocity towards rigid motion: a number in [0, 1]
        """
    @k_damping.setter
    def k_damping(self, value: float) -> None:
        ...
    @property
    def k_friction(self) -> float:
        """
        Friction against proxies and itself: a number in [0, 1]
        """
    @k_friction.setter
    def k_friction(self, value: float) -> None:
        ...
    @property
    def k_stretch(self) -> float:
        """
        Stretching stiffness, as a share: a number in (0, 1]. In N/m: spring_constant(). Below 0.99 cloth hangs like rubber
        """
    @k_stretch.setter
    def k_stretch(self, value: float) -> None:
        ...
class Capsule:
    """
    Tapered capsule in the world, m.
    """
    def __init__(self, p0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], p1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], r0: float, r1: float) -> None:
        ...
    @property
    def p0(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, one end of the axis
        """
    @p0.setter
    def p0(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def p1(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m, the other end
        """
    @p1.setter
    def p1(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def r0(self) -> float:
        """
        m, radius at p0
        """
    @r0.setter
    def r0(self, value: float) -> None:
        ...
    @property
    def r1(self) -> float:
        """
        m, radius at p1
        """
    @r1.setter
    def r1(self, value: float) -> None:
        ...
class ClothState:
    """
    Positions (N, 3) m and velocities (N, 3) m/s; copy() saves it.
    """
    def __init__(self, positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    def copy(self) -> ClothState:
        """
        A state of its own.
        """
    @property
    def positions(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (N, 3) m
        """
    @positions.setter
    def positions(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def velocities(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (N, 3) m/s
        """
    @velocities.setter
    def velocities(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
class StepInputs:
    """
    What the world does during one frame.
    """
    def __init__(self, *, targets: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] = ..., previous_targets: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] = ..., capsules: collections.abc.Sequence[Capsule] = [], previous_capsules: collections.abc.Sequence[Capsule] = [], dt: float = 0.025, wind: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ..., gravity: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] | None = None, substeps: int = 0) -> None:
        ...
    @property
    def capsules(self) -> list[Capsule]:
        """
        proxies at the end of the frame
        """
    @capsules.setter
    def capsules(self, value: collections.abc.Sequence[Capsule]) -> None:
        ...
    @property
    def dt(self) -> float:
        """
        s
        """
    @dt.setter
    def dt(self, value: float) -> None:
        ...
    @property
    def gravity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"] | None:
        """
        m/s^2; None = the model's
        """
    @gravity.setter
    def gravity(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] | None) -> None:
        ...
    @property
    def previous_capsules(self) -> list[Capsule]:
        """
        proxies at its start, in the same order; empty = they stand still
        """
    @previous_capsules.setter
    def previous_capsules(self, value: collections.abc.Sequence[Capsule]) -> None:
        ...
    @property
    def previous_targets(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (N, 3) m, at its start; empty = they stand still
        """
    @previous_targets.setter
    def previous_targets(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def substeps(self) -> int:
        """
        number of substeps of the frame; 0 = the model's
        """
    @substeps.setter
    def substeps(self, value: int) -> None:
        ...
    @property
    def targets(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (N, 3) m, skinned positions at the end of the frame; empty if no vertex follows them
        """
    @targets.setter
    def targets(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
    @property
    def wind(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        m/s
        """
    @wind.setter
    def wind(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
class ClothOptions:
    """
    Settings of the cloth solver.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    @staticmethod
    def paper() -> ClothOptions:
        """
        The settings of the paper.
        """
    def __copy__(self) -> ClothOptions:
        ...
    def __deepcopy__(self, memo: dict) -> ClothOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, iterations: int = 6, substeps: int = 4, stiffness: typing.Literal['sweeps', 'compliance'] = 'compliance', over_relaxation: float = 1.5, rest_curvature: float = 0.0, gravity: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, '[3, 1]'] = ..., restitution: float = 0.0, thickness: float = 0.012, self_thickness: float = 0.004, self_collision: bool = True, edge_collision: bool = False) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def edge_collision(self) -> bool:
        """
        Edges collide with edges, too, where cloth collides with itself
        """
    @edge_collision.setter
    def edge_collision(self, value: bool) -> None:
        ...
    @property
    def gravity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        m/s^2, Acceleration of free cloth: a number in [-1000, 1000]
        """
    @gravity.setter
    def gravity(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def iterations(self) -> int:
        """
        Number of Gauss-Seidel sweeps in a substep: a number in [1, 10000]. The paper has 24 a frame, in one step
        """
    @iterations.setter
    def iterations(self, value: int) -> None:
        ...
    @property
    def over_relaxation(self) -> float:
        """
        Factor of stretch corrections, at most 1 + 16^(-1/iterations); under 'compliance' alone: a number in [1, 1.6]. The same sweeps come further
        """
    @over_relaxation.setter
    def over_relaxation(self, value: float) -> None:
        ...
    @property
    def rest_curvature(self) -> float:
        """
        Share of the rest mesh's angles that bending keeps; 0 = cut flat: a number in [0, 1]. A garment's rest shape is blown up, not sewn so
        """
    @rest_curvature.setter
    def rest_curvature(self, value: float) -> None:
        ...
    @property
    def restitution(self) -> float:
        """
        Share of the normal velocity that a contact reflects; 0 = inelastic: a number in [0, 1]. Only of what arrives faster than two steps of gravity
        """
    @restitution.setter
    def restitution(self, value: float) -> None:
        ...
    @property
    def self_collision(self) -> bool:
        """
        Cloth collides with itself
        """
    @self_collision.setter
    def self_collision(self, value: bool) -> None:
        ...
    @property
    def self_thickness(self) -> float:
        """
        m, Distance that is kept between cloth and itself: a number in [0, 1]. Pairs that are closer at rest are left alone
        """
    @self_thickness.setter
    def self_thickness(self, value: float) -> None:
        ...
    @property
    def stiffness(self) -> str:
        """
        Meaning of k_bend and k_stretch: XPBD's compliance, or by sweeps as in the paper: one of 'sweeps', 'compliance'. Under 'compliance' a material means the same whatever the sweeps and substeps
        """
    @stiffness.setter
    def stiffness(self, value: str) -> None:
        ...
    @property
    def substeps(self) -> int:
        """
        Number of steps in a frame: a number in [1, 1000]. Targets and proxies are interpolated, friction and damping shared out
        """
    @substeps.setter
    def substeps(self, value: int) -> None:
        ...
    @property
    def thickness(self) -> float:
        """
        m, Distance that is kept between cloth and proxies: a number in [0, 1]. Its own, the sag of an edge round a shin, and what the proxies are slimmer than the body
        """
    @thickness.setter
    def thickness(self, value: float) -> None:
        ...
class ClothModel:
    """
    What a piece of cloth is: arrays that cannot be written to.
    """
    def __init__(self, rest: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], clothness: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], options: ClothOptions = ...) -> None:
        ...
    @property
    def clothness(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (N) in [0, 1]: 0 = follows its target, 1 = free
        """
    @property
    def faces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        (F, 3)
        """
    @property
    def inverse_masses(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (N) 1/m^2, 0 = pinned
        """
    @property
    def options(self) -> ClothOptions:
        """
        A copy.
        """
    @property
    def rest(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (N, 3) m: rest lengths and angles come from here
        """
    @property
    def vertex_count(self) -> int:
        """
        N
        """
class ClothSolver:
    """
    Advances simulations of one model by a frame. To replace it, define advance(states, inputs, materials, threads) in a subclass: one of each for every simulation, checked; it changes the states in place, and may return the indices of those that came out not finite. What is not finite is left as it was.
    """
    @staticmethod
    def create(model: ClothModel) -> ClothSolver:
        """
        The built-in solver.
        """
    def __init__(self, model: ClothModel) -> None:
        ...
    def advance(self, states: collections.abc.Sequence[ClothState], inputs: collections.abc.Sequence[StepInputs], materials: collections.abc.Sequence[Material], threads: int) -> list[int] | None:
        """
        For subclasses to define, and for step_batch to call: changes the states in place; returns the indices of those that came out not finite, or None.
        """
    def step(self, state: ClothState, inputs: StepInputs, material: Material) -> None:
        """
        Advances the state by one frame.
        """
    def step_batch(self, states: collections.abc.Sequence[ClothState], inputs: collections.abc.Sequence[StepInputs], materials: collections.abc.Sequence[Material], threads: int = 1) -> list[int]:
        """
        step() for several simulations side by side in the lanes of a register, with the same bits: states[i] with inputs[i], or inputs[0] if there is but one, and materials[i]. Returns the indices of those that came out not finite and were left as they were.
        """
    @property
    def model(self) -> ClothModel:
        """
        ClothModel that it was made for
        """
class SolverSettings:
    """
    How the cloth was simulated when its material was estimated.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> SolverSettings:
        ...
    def __deepcopy__(self, memo: dict) -> SolverSettings:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    @typing.overload
    def __init__(self, *, dt: float = 0.025, cloth: ClothOptions = ...) -> None:
        """
        Every field may be given by keyword.
        """
    @typing.overload
    def __init__(self, dt: float, cloth: ClothOptions = ...) -> None:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def cloth(self) -> ClothOptions:
        """
        Options of the cloth solver
        """
    @cloth.setter
    def cloth(self, value: ClothOptions) -> None:
        ...
    @property
    def dt(self) -> float:
        """
        s, Duration of one frame: a number in (0, 1]
        """
    @dt.setter
    def dt(self, value: float) -> None:
        ...
class PosedFrame:
    """
    A pose worked out once: skinned surface and proxies.
    """
    @property
    def capsules(self) -> list[Capsule]:
        """
        proxies in the pose
        """
    @property
    def skinned(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
class CharacterState:
    """
    Simulated state of all cloth regions; copy() saves it.
    """
    def copy(self) -> CharacterState:
        """
        A state of its own.
        """
    @property
    def regions(self) -> list[ClothState]:
        """
        ClothState of each cloth region
        """
    @regions.setter
    def regions(self, value: collections.abc.Sequence[ClothState]) -> None:
        ...
class ClothRegion:
    """
    One piece of cloth: the faces with a vertex of the region, and the ring they hang from.
    """
    @property
    def model(self) -> ClothModel:
        """
        ClothModel
        """
    @property
    def vertex_from_cloth(self) -> list[int]:
        """
        (N) index into the actor's vertices
        """
class CharacterSimulator:
    """
    The forward model: pose in, surface out.
    """
    def __init__(self, actor: RiggedMesh, segmentation: Segmentation, proxies: collections.abc.Sequence[TaperedCapsule], options: ClothOptions = ..., make_solver: collections.abc.Callable[[ClothModel], ClothSolver] | None = None) -> None:
        """
        make_solver(ClothModel) -> ClothSolver, of each cloth region; None = the built-in one.
        """
    def pose(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> PosedFrame:
        """
        The PosedFrame of a pose (D).
        """
    def settle(self, state: CharacterState, frame: PosedFrame, materials: collections.abc.Sequence[Material], dt: float, frames: int) -> None:
        """
        Lets the cloth fall into place in a still pose for so many frames, then takes its velocity.
        """
    def start(self, frame: PosedFrame, surface: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] | None = None) -> CharacterState:
        """
        Cloth at rest: at `surface` (V, 3) if given, else at its rest shape or skinned position.
        """
    def step(self, state: CharacterState, previous: PosedFrame, current: PosedFrame, materials: collections.abc.Sequence[Material], dt: float) -> None:
        """
        Advances every cloth region from one posed frame to the next; materials: one a region.
        """
    def step_batch(self, states: collections.abc.Sequence[CharacterState], previous: PosedFrame, current: PosedFrame, materials: collections.abc.Sequence[collections.abc.Sequence[Material]], dt: float) -> list[tuple[int, int]]:
        """
        step() for several characters side by side in the lanes of a register, with the same bits; materials[i]: one a region of states[i]. Returns pairs (index of the state, region) of what came out not finite and was left as it was.
        """
    def surface(self, state: CharacterState, frame: PosedFrame) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
    @property
    def actor(self) -> RiggedMesh:
        """
        RiggedMesh that is simulated
        """
    @property
    def region_count(self) -> int:
        """
        cloth regions
        """
    @property
    def regions(self) -> list[ClothRegion]:
        """
        ClothRegion of each
        """
class Character:
    """
    The animatable character: everything that a new animation needs (character.glb).
    """
    @staticmethod
    def read(path: os.PathLike | str | bytes) -> Character:
        """
        character.glb. Raises FileNotFoundError, or Error naming the file; other files are never followed.
        """
    def write(self, path: os.PathLike | str | bytes) -> None:
        """
        character.glb, complete or not at all.
        """
    @property
    def actor(self) -> RiggedMesh:
        """
        RiggedMesh: surface, skeleton, skin weights
        """
    @actor.setter
    def actor(self, value: RiggedMesh) -> None:
        ...
    @property
    def body(self) -> Mesh:
        """
        the body under the clothes, scan pose; may be empty
        """
    @body.setter
    def body(self, value: Mesh) -> None:
        ...
    @property
    def body_colour(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        linear RGB in [0, 1]
        """
    @body_colour.setter
    def body_colour(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def body_shown(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (FB) 1 = hidden under cloth in the scan, must be drawn
        """
    @body_shown.setter
    def body_shown(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def garment_subdivisions(self) -> int:
        """
        of the garment in `high`; -1 = none is
        """
    @garment_subdivisions.setter
    def garment_subdivisions(self, value: int) -> None:
        ...
    @property
    def high(self) -> Mesh:
        """
        M_high, what is displayed, scan pose; may be empty: then M is
        """
    @high.setter
    def high(self, value: Mesh) -> None:
        ...
    @property
    def high_body(self) -> list[int]:
        """
        the last of M_high's skin that are the body's, welded to the scan: the vertex of `body` that each is; empty = the hidden body is drawn beside M_high
        """
    @high_body.setter
    def high_body(self, value: collections.abc.Sequence[int]) -> None:
        ...
    @property
    def high_valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (FH) 0 = a face of M_high that is not drawn
        """
    @high_valid.setter
    def high_valid(self, value: numpy.typing.ArrayLike) -> None:
        ...
    @property
    def materials(self) -> list[Material]:
        """
        one a cloth region
        """
    @materials.setter
    def materials(self, value: collections.abc.Sequence[Material]) -> None:
        ...
    @property
    def name(self) -> str:
        """
        of the character
        """
    @name.setter
    def name(self, value: str) -> None:
        ...
    @property
    def proxies(self) -> list[TaperedCapsule]:
        """
        TaperedCapsules that the cloth collides with
        """
    @proxies.setter
    def proxies(self, value: collections.abc.Sequence[TaperedCapsule]) -> None:
        ...
    @property
    def segmentation(self) -> Segmentation:
        """
        what of the surface is cloth
        """
    @segmentation.setter
    def segmentation(self, value: Segmentation) -> None:
        ...
    @property
    def solver(self) -> SolverSettings:
        """
        SolverSettings, without which the materials mean nothing
        """
    @solver.setter
    def solver(self, value: SolverSettings) -> None:
        ...
    @property
    def texcoords(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 2]"]:
        """
        (3 FH, 2) per corner of `high`
        """
    @texcoords.setter
    def texcoords(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 2]"]) -> None:
        ...
    @property
    def texture(self) -> bytes:
        """
        a PNG or JPEG file as bytes; empty = none
        """
    @texture.setter
    def texture(self, value: bytes) -> None:
        ...
class Motion:
    """
    Poses of a character's skeleton at a constant rate.
    """
    def __init__(self, fps: float, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
    def __len__(self) -> int:
        ...
    @property
    def dofs(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (T, D) rad and m
        """
    @dofs.setter
    def dofs(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
    @property
    def fps(self) -> float:
        """
        frames a second
        """
    @fps.setter
    def fps(self, value: float) -> None:
        ...
class SourceMotion:
    """
    A motion capture clip on its own skeleton.
    """
    @staticmethod
    def read(path: os.PathLike | str | bytes, skeleton: os.PathLike | str | bytes | None = None, animation: str = '') -> SourceMotion:
        """
        .bvh, .amc or .glb; skeleton: the .asf of an .amc; animation: of a .glb, by name or number from 1, '' = the first that moves the body
        """
    def __init__(self, joint_names: collections.abc.Sequence[str], joint_parents: collections.abc.Sequence[int], offsets: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], positions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], rotations: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], fps: float, source: str = 'arrays') -> None:
        """
        From arrays, parents before children (-1 = root): offsets (J, 3) from the parent in the zero pose, positions (T, J, 3) in the world, rotations (T, J, 4) in the world, relative to the zero pose, unit quaternions w x y z. Any unit of length.
        """
    @property
    def animation(self) -> int:
        """
        which of these this is, counted from 0
        """
    @property
    def animations(self) -> list[str]:
        """
        names of all that the file has, where it can have several (.glb)
        """
    @property
    def fps(self) -> float:
        """
        frames a second
        """
    @property
    def frame_count(self) -> int:
        """
        T
        """
    @property
    def joint_names(self) -> list[str]:
        """
        (J) as the file has them
        """
    @property
    def joint_parents(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"]:
        """
        (J) indices, -1 = none
        """
    @property
    def offsets(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (J, 3) from the parent in the zero pose, file units
        """
    @property
    def positions(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (T, J, 3) world, file units; a copy
        """
    @property
    def rotations(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (T, J, 4) world, relative to the zero pose, w x y z; a copy
        """
    @property
    def source(self) -> str:
        """
        file name, for messages
        """
class RetargetOptions:
    """
    Options of retarget.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> RetargetOptions:
        ...
    def __deepcopy__(self, memo: dict) -> RetargetOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, fps: float = 0.0, first_second: float = 0.0, last_second: float = 1000000000.0, align_start: bool = True, apply_limits: bool = True, ground_feet: bool = True, plant_feet: bool = True, hold_seconds: float = 0.1, blend_seconds: float = 0.6, joint_names: collections.abc.Mapping[str, str] = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def align_start(self) -> bool:
        """
        The motion starts where the actor stands in the rest pose, facing the same way
        """
    @align_start.setter
    def align_start(self, value: bool) -> None:
        ...
    @property
    def apply_limits(self) -> bool:
        """
        Hinges and balls are kept inside the skeleton's limits
        """
    @apply_limits.setter
    def apply_limits(self, value: bool) -> None:
        ...
    @property
    def blend_seconds(self) -> float:
        """
        s, Time from the rest pose to the first pose; 0 with hold_seconds 0 = the clip alone: a number in [0, 60]. Cloth is not torn away
        """
    @blend_seconds.setter
    def blend_seconds(self, value: float) -> None:
        ...
    @property
    def first_second(self) -> float:
        """
        s, Time in the file at which the motion starts: a number of at least 0
        """
    @first_second.setter
    def first_second(self, value: float) -> None:
        ...
    @property
    def fps(self) -> float:
        """
        1/s, Frame rate of the result; 0 = that of the file: a number of at least 0. Give the character's 1/dt
        """
    @fps.setter
    def fps(self, value: float) -> None:
        ...
    @property
    def ground_feet(self) -> bool:
        """
        The whole clip is shifted so that feet reach the floor as in the rest pose, and not below
        """
    @ground_feet.setter
    def ground_feet(self, value: bool) -> None:
        ...
    @property
    def hold_seconds(self) -> float:
        """
        s, Time in the rest pose before the motion, see blend_in(): a number in [0, 60]
        """
    @hold_seconds.setter
    def hold_seconds(self, value: float) -> None:
        ...
    @property
    def joint_names(self) -> dict[str, str]:
        """
        Our joint -> joint of the file, for names that are not known. CMU, Acclaim, iClone, Mixamo, Biped and our own are known
        """
    @joint_names.setter
    def joint_names(self, value: collections.abc.Mapping[str, str]) -> None:
        ...
    @property
    def last_second(self) -> float:
        """
        s, Time in the file at which the motion stops: a number of at least 0
        """
    @last_second.setter
    def last_second(self, value: float) -> None:
        ...
    @property
    def plant_feet(self) -> bool:
        """
        Feet are planted where they stand, and none is below the floor, see plant_feet()
        """
    @plant_feet.setter
    def plant_feet(self, value: bool) -> None:
        ...
class JointMatch:
    """
    Which joint of a clip plays one of our joints, and why.
    """
    @property
    def joint(self) -> int:
        """
        index into the clip's joint_names; -1 = none
        """
    @property
    def part(self) -> str:
        """
        our joint
        """
    @property
    def reason(self) -> str:
        """
        why, in words
        """
class PlantOptions:
    """
    Options of plant_feet and find_contacts.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> PlantOptions:
        ...
    def __deepcopy__(self, memo: dict) -> PlantOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, contact_height: float = 0.05, contact_speed: float = 0.35, blend_seconds: float = 0.15, max_pelvis_drop: float = 0.08, floor_height: float = 0.0) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def blend_seconds(self) -> float:
        """
        s, Time in which a foot goes from its own path to where it stands: a number in [0, 2]
        """
    @blend_seconds.setter
    def blend_seconds(self, value: float) -> None:
        ...
    @property
    def contact_height(self) -> float:
        """
        m, Heel or ball may stand if this close to the lowest point within 0.75 s: a number in [0, 1]. A contact lasts up to 1.4 times it
        """
    @contact_height.setter
    def contact_height(self, value: float) -> None:
        ...
    @property
    def contact_speed(self) -> float:
        """
        m/s, Heel or ball may stand if it is as slow as this: a number in [0, 10]. A contact lasts up to 1.6 times it
        """
    @contact_speed.setter
    def contact_speed(self, value: float) -> None:
        ...
    @property
    def floor_height(self) -> float:
        """
        m, Height of the floor that the feet stand on in the rest pose: a finite number
        """
    @floor_height.setter
    def floor_height(self, value: float) -> None:
        ...
    @property
    def max_pelvis_drop(self) -> float:
        """
        m, The hips may go down this far for feet to reach where they stand: a number in [0, 0.5]. Beyond that the feet let go
        """
    @max_pelvis_drop.setter
    def max_pelvis_drop(self, value: float) -> None:
        ...
class FootContacts:
    """
    When one foot of a motion stands.
    """
    @property
    def ankle(self) -> str:
        """
        joint
        """
    @property
    def ball(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (T,) bool
        """
    @property
    def heel(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (T,) bool
        """
class AnimateOptions:
    """
    Options of animate.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> AnimateOptions:
        ...
    def __deepcopy__(self, memo: dict) -> AnimateOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, settle_seconds: float = 1.0, rest_damping: float = 6.0, edge_collision: bool = True, redrape_when_tangled: bool = True, high: bool = True, body: bool = True, resolve_arm_penetration: bool = True, resolve_body_penetration: bool = True) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def body(self) -> bool:
        """
        The animation has the body under the clothes, too
        """
    @body.setter
    def body(self, value: bool) -> None:
        ...
    @property
    def edge_collision(self) -> bool:
        """
        Edges of the cloth collide with edges, and crossings are moved apart. Whatever the character's solver says
        """
    @edge_collision.setter
    def edge_collision(self, value: bool) -> None:
        ...
    @property
    def high(self) -> bool:
        """
        The animation has the display surface M_high, too
        """
    @high.setter
    def high(self, value: bool) -> None:
        ...
    @property
    def redrape_when_tangled(self) -> bool:
        """
        The garment is draped anew when it is tangled, in a held pose or for long in motion. When a pose is held for 0.75 s and over 0.5 % of the faces cross or a limb is through the cloth; in motion, when it is all in a knot for 0.5 s. The new state is used if it is better, and blended in over 0.5 s
        """
    @redrape_when_tangled.setter
    def redrape_when_tangled(self, value: bool) -> None:
        ...
    @property
    def resolve_arm_penetration(self) -> bool:
        """
        animate() turns shoulders so far that forearms and hands are clear of the body, with room for cloth. Another person's clip presses the arms into a wider body. A player takes its poses as they are
        """
    @resolve_arm_penetration.setter
    def resolve_arm_penetration(self, value: bool) -> None:
        ...
    @property
    def resolve_body_penetration(self) -> bool:
        """
        The body is drawn under the surface where it would stand out of it. Proxies are simpler than the body, so cloth may rest a little inside it
        """
    @resolve_body_penetration.setter
    def resolve_body_penetration(self, value: bool) -> None:
        ...
    @property
    def rest_damping(self) -> float:
        """
        1/s, Damping of cloth in still air that is reached within 1 s while a pose is held; 0 = off: a number in [0, 100]. It grows from 0.25 s after the last motion on
        """
    @rest_damping.setter
    def rest_damping(self, value: float) -> None:
        ...
    @property
    def settle_seconds(self) -> float:
        """
        s, The cloth falls into place in the first pose for this long before the animation starts: a number in [0, 60]
        """
    @settle_seconds.setter
    def settle_seconds(self, value: float) -> None:
        ...
class AnimationResult:
    """
    An animation in memory; an array is put together at its first access, and kept.
    """
    @property
    def body(self) -> typing.Any:
        """
        (T, B, 3) m
        """
    @property
    def dofs(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (T, D)
        """
    @property
    def fps(self) -> float:
        """
        frames a second, the character's
        """
    @property
    def high(self) -> typing.Any:
        """
        (T, VH, 3) m
        """
    @property
    def joints(self) -> typing.Any:
        """
        (T, J, 3) m
        """
    @property
    def surface(self) -> typing.Any:
        """
        (T, V, 3) m
        """
class AnimationFrame:
    """
    One frame of an animation; keep copies, the arrays are gone after the call.
    """
    @property
    def body(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (B, 3) m, or empty
        """
    @property
    def dofs(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (D)
        """
    @property
    def high(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (VH, 3) m, or empty
        """
    @property
    def index(self) -> int:
        """
        of the animation, from 0
        """
    @property
    def joints(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (J, 3) m
        """
    @property
    def surface(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
class BakedGlbOptions:
    """
    Options of write_baked_glb.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> BakedGlbOptions:
        ...
    def __deepcopy__(self, memo: dict) -> BakedGlbOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, keys_per_second: float = 0.0, max_keys: int = 400) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def keys_per_second(self) -> float:
        """
        1/s, Shapes that are stored a second; 0 = one a frame: a number in [0, 1000]. Viewers blend between them; at 10 loose cloth is up to 2 cm off
        """
    @keys_per_second.setter
    def keys_per_second(self, value: float) -> None:
        ...
    @property
    def max_keys(self) -> int:
        """
        Shapes that are stored at most: a number in [2, 5000]. A long clip gets fewer keys a second rather than a file of hundreds of megabytes
        """
    @max_keys.setter
    def max_keys(self, value: int) -> None:
        ...
class Player:
    """
    A character that is moved as it is watched: a pose in, a surface out, a frame at a time. The arrays of the AnimationFrame that it returns are views, which the next step writes over: copy what you keep.
    """
    def __init__(self, character: Character, options: AnimateOptions = ..., make_solver: collections.abc.Callable[[ClothModel], ClothSolver] | None = None) -> None:
        """
        Stands in the rest pose; begin with reset(). make_solver: as of CharacterSimulator.
        """
    def copy(self) -> Player:
        """
        A character of its own, which shares what never changes: see step_players.
        """
    def reset(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> AnimationFrame:
        """
        Begins anew in this pose (D): the cloth falls into place for AnimateOptions.settle_seconds.
        """
    def step(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], seconds: float | None = None) -> AnimationFrame:
        """
        Goes on to this pose (D) in `seconds`, in (0, 1]; None = the character's own step. The cloth moves alike at every frame rate. Raises Error if it comes out not finite; it then stays as it was, and reset() helps.
        """
    def teleport(self, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> AnimationFrame:
        """
        Stands in this pose (D) at once; the cloth is carried along with the root, with its speed.
        """
    @property
    def character(self) -> Character:
        """
        Character that is played
        """
    @property
    def frame(self) -> AnimationFrame:
        """
        The last AnimationFrame.
        """
    @property
    def gravity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m/s^2, within 1000
        """
    @gravity.setter
    def gravity(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def materials(self) -> list[Material]:
        """
        One a cloth region; assign a list to change them.
        """
    @materials.setter
    def materials(self, value: collections.abc.Sequence[Material]) -> None:
        ...
    @property
    def proxies(self) -> list[TaperedCapsule]:
        """
        Tapered capsules that the cloth collides with; assign a list to change them.
        """
    @proxies.setter
    def proxies(self, value: collections.abc.Sequence[TaperedCapsule]) -> None:
        ...
    @property
    def state(self) -> CharacterState:
        """
        A copy of the cloth's positions and velocities; assign it to go back.
        """
    @state.setter
    def state(self, value: CharacterState) -> None:
        ...
    @property
    def wind(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) m/s
        """
    @wind.setter
    def wind(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
class RenderMesh:
    """
    One mesh of a picture; colours in [0, 1], RGB.
    """
    def __init__(self, vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], colour: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"] = ..., colours: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] | None = None, face_valid: numpy.typing.ArrayLike = []) -> None:
        ...
    @property
    def colour(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        (3) B G R in [0, 1]
        """
    @colour.setter
    def colour(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def faces(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        (F, 3)
        """
    @faces.setter
    def faces(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> None:
        ...
    @property
    def vertices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V, 3) m
        """
    @vertices.setter
    def vertices(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> None:
        ...
class RenderOptions:
    """
    Options of render.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> RenderOptions:
        ...
    def __deepcopy__(self, memo: dict) -> RenderOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, background: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, '[3, 1]'] = ..., floor: bool = True, floor_height: float = 0.0, light: float = 0.75, light_direction: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, '[3, 1]'] = ..., supersample: bool = True) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def background(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        Colour of the background, R G B: a number in [0, 1]
        """
    @background.setter
    def background(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def floor(self) -> bool:
        """
        A grid is drawn at floor_height, with the soft shadow of the meshes
        """
    @floor.setter
    def floor(self, value: bool) -> None:
        ...
    @property
    def floor_height(self) -> float:
        """
        m, Height of the grid: a finite number
        """
    @floor_height.setter
    def floor_height(self, value: float) -> None:
        ...
    @property
    def light(self) -> float:
        """
        Share of the key light; the rest is the sky: a number in [0, 1]
        """
    @light.setter
    def light(self, value: float) -> None:
        ...
    @property
    def light_direction(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        Direction to the light in the world, of any length but 0: a finite number
        """
    @light_direction.setter
    def light_direction(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def supersample(self) -> bool:
        """
        Every pixel is the mean of 2 x 2 samples
        """
    @supersample.setter
    def supersample(self, value: bool) -> None:
        ...
class CharacterRenderer:
    """
    Pictures of one character in many frames; safe from many threads.
    """
    def __init__(self, character: Character) -> None:
        ...
    def meshes(self, surface: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], high: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], body: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> list[RenderMesh]:
        """
        The RenderMesh objects of a frame.
        """
    def render(self, surface: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], high: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], body: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], camera: Camera, options: RenderOptions = ...) -> numpy.typing.NDArray[numpy.uint8]:
        """
        (H, W, 3) uint8, BGR
        """
class TextureOptions:
    """
    Options of texture_character.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> TextureOptions:
        ...
    def __deepcopy__(self, memo: dict) -> TextureOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, size: int = 2048, frames: int = 16, facing_power: float = 4.0, grazing: float = 0.2, depth_margin: float = 0.01, edge_margin: float = 0.02, screen_margin: float = 0.025, label_margin: float = 0.05, albedo: bool = True) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def albedo(self) -> bool:
        """
        The light of the images is divided out of the texture; off = as photographed. Whoever draws it can then light it
        """
    @albedo.setter
    def albedo(self, value: bool) -> None:
        ...
    @property
    def depth_margin(self) -> float:
        """
        m, A point this far behind the z-buffer's surface is hidden: a number above 0
        """
    @depth_margin.setter
    def depth_margin(self, value: float) -> None:
        ...
    @property
    def edge_margin(self) -> float:
        """
        m, A point does not count this close to the edge of something in front of it: a number in [0, 1]. Legs at a hem
        """
    @edge_margin.setter
    def edge_margin(self, value: float) -> None:
        ...
    @property
    def facing_power(self) -> float:
        """
        Cameras count by the cosine between normal and ray to this power: a number in [0, 64]
        """
    @facing_power.setter
    def facing_power(self, value: float) -> None:
        ...
    @property
    def frames(self) -> int:
        """
        Frames of the take that it is made of, at most: a number in [1, 64]. Each costs the time to look at its images once
        """
    @frames.setter
    def frames(self, value: int) -> None:
        ...
    @property
    def grazing(self) -> float:
        """
        Cameras below this cosine do not count: a number in [0, 1). They see the silhouette's mixed pixels
        """
    @grazing.setter
    def grazing(self, value: float) -> None:
        ...
    @property
    def label_margin(self) -> float:
        """
        m, Body and garment do not take each other's colour where seen this close together; 0 = they may: a number in [0, 0.5]. Where they are 3 cm apart in depth: hands before a skirt
        """
    @label_margin.setter
    def label_margin(self, value: float) -> None:
        ...
    @property
    def screen_margin(self) -> float:
        """
        Pixels of the screen's colour do not count this far inside the silhouette; 0 = they do: a number in [0, 0.5]. A share of the image's smaller side, and deeper where the actor has next to none of the colour: gaps between fingers
        """
    @screen_margin.setter
    def screen_margin(self, value: float) -> None:
        ...
    @property
    def size(self) -> int:
        """
        px, Width and height of the image: a number in [64, 16384]. In 2048, a pixel of a person is about 1.1 mm wide
        """
    @size.setter
    def size(self, value: int) -> None:
        ...
class DisplayMesh:
    """
    What is drawn of a character, in the scan pose.
    """
    @property
    def garment_subdivisions(self) -> int:
        """
        -1 = `mesh` is one surface, as scanned
        """
    @property
    def mesh(self) -> Mesh:
        """
        M_high, scan pose
        """
    @property
    def valid(self) -> numpy.typing.NDArray[numpy.bool_]:
        """
        (FH) 0 = not drawn
        """
class DisplaySurface:
    """
    The display mesh of a character, which follows its M.
    """
    def __init__(self, character: Character) -> None:
        ...
    def apply(self, surface: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (VH, 3) for the vertices (V, 3) of M
        """
    def sample(self, values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (VH, C) values of M's vertices (V, C)
        """
class SurfaceTransfer:
    """
    A fine mesh that follows a coarse one.
    """
    def __init__(self, coarse: Mesh, coarse_valid: numpy.typing.ArrayLike, fine: Mesh, fine_valid: numpy.typing.ArrayLike) -> None:
        ...
    def apply(self, coarse: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        (V', 3) fine vertices for the coarse (V, 3)
        """
class OptimizerResult:
    """
    Where an optimiser stands.
    """
    def __init__(self) -> None:
        ...
    @property
    def answer(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) what the method returns: CMA-ES the mean of its distribution, annealing the best sample
        """
    @answer.setter
    def answer(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def best(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) best sample so far
        """
    @best.setter
    def best(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def best_energy(self) -> float:
        """
        its energy; means nothing while evaluations is 0
        """
    @best_energy.setter
    def best_energy(self, value: float) -> None:
        ...
    @property
    def deviations(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) standard deviation of the search along each axis
        """
    @deviations.setter
    def deviations(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def evaluations(self) -> int:
        """
        samples told so far
        """
    @evaluations.setter
    def evaluations(self, value: int) -> None:
        ...
    @property
    def generations(self) -> int:
        """
        told so far
        """
    @generations.setter
    def generations(self, value: int) -> None:
        ...
    @property
    def stop_reason(self) -> str:
        """
        empty while it runs
        """
    @stop_reason.setter
    def stop_reason(self, value: str) -> None:
        ...
class Optimizer:
    """
    Swap point: ask() a generation, tell() its energies. Box [0, 1]^n.
    """
    def __init__(self) -> None:
        ...
    def ask(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (S, n) the next generation.
        """
    def restore(self, state: str) -> None:
        """
        Goes on where the saved optimiser stood, to the same bits.
        """
    def result(self) -> OptimizerResult:
        """
        Where the search stands.
        """
    def save(self) -> str:
        """
        The exact state as text; empty = cannot be saved.
        """
    def stop(self) -> bool:
        """
        Is the search over?
        """
    def tell(self, samples: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"], energies: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]) -> None:
        """
        samples (S, n) as asked, energies (S); lower is better.
        """
class CmaEsOptions:
    """
    Options of create_cma_es.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> CmaEsOptions:
        ...
    def __deepcopy__(self, memo: dict) -> CmaEsOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, population: int = 0, initial_mean: float = 0.5, initial_sigma: float = 0.3, max_evaluations: int = 512, min_deviation: float = 0.025, stagnation: float = 0.02, seed: int = 1) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def initial_mean(self) -> float:
        """
        Mean at the start along every axis; 0.5 = the centre of the box: a finite number
        """
    @initial_mean.setter
    def initial_mean(self, value: float) -> None:
        ...
    @property
    def initial_sigma(self) -> float:
        """
        Standard deviation at the start along every axis: a number above 0. At 0.3 the box is about +-1.7 of them
        """
    @initial_sigma.setter
    def initial_sigma(self, value: float) -> None:
        ...
    @property
    def max_evaluations(self) -> int:
        """
        No generation begins at or beyond this number of evaluations: a number of at least 1. 512 is the paper's
        """
    @max_evaluations.setter
    def max_evaluations(self, value: int) -> None:
        ...
    @property
    def min_deviation(self) -> float:
        """
        The search stops when all standard deviations are below this: a number of at least 0. 0.025 is the paper's
        """
    @min_deviation.setter
    def min_deviation(self, value: float) -> None:
        ...
    @property
    def population(self) -> int:
        """
        Number of samples in a generation; 0 = Hansen's 4 + floor(3 ln n): a number of at least 0. 8 for n = 5, 9 for n = 6
        """
    @population.setter
    def population(self, value: int) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the random numbers: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
    @property
    def stagnation(self) -> float:
        """
        The search stops when best and median energies change by less than this share; 0 = never: a number of at least 0
        """
    @stagnation.setter
    def stagnation(self, value: float) -> None:
        ...
class AnnealingOptions:
    """
    Options of create_simulated_annealing.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> AnnealingOptions:
        ...
    def __deepcopy__(self, memo: dict) -> AnnealingOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, chains: int = 4, max_evaluations: int = 2048, initial_step: float = 0.3, final_step: float = 0.025, initial_temperature: float = 0.3, final_temperature: float = 0.001, seed: int = 1) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def chains(self) -> int:
        """
        Number of chains, which is that of the samples in a generation: a number of at least 1
        """
    @chains.setter
    def chains(self, value: int) -> None:
        ...
    @property
    def final_step(self) -> float:
        """
        Standard deviation of a step at the end, in box units: a number above 0
        """
    @final_step.setter
    def final_step(self, value: float) -> None:
        ...
    @property
    def final_temperature(self) -> float:
        """
        Temperature at the end, as a share of the first generation's mean energy: a number above 0
        """
    @final_temperature.setter
    def final_temperature(self, value: float) -> None:
        ...
    @property
    def initial_step(self) -> float:
        """
        Standard deviation of a step at the start, in box units: a number above 0
        """
    @initial_step.setter
    def initial_step(self, value: float) -> None:
        ...
    @property
    def initial_temperature(self) -> float:
        """
        Temperature at the start, as a share of the first generation's mean energy: a number above 0
        """
    @initial_temperature.setter
    def initial_temperature(self, value: float) -> None:
        ...
    @property
    def max_evaluations(self) -> int:
        """
        Length of the cooling schedule in evaluations: a number of at least 1. The paper needs 2 to 4 times as many as with CMA-ES
        """
    @max_evaluations.setter
    def max_evaluations(self, value: int) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the random numbers: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
class BayesianOptions:
    """
    Options of create_bayesian.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> BayesianOptions:
        ...
    def __deepcopy__(self, memo: dict) -> BayesianOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, population: int = 32, max_evaluations: int = 512, min_gain: float = 0.02, levels: int = 0, seed: int = 1, first: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, '[m, n]'] = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def first(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (K, n) samples of the first generation; empty = spread evenly
        """
    @first.setter
    def first(self, value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"]) -> None:
        ...
    @property
    def levels(self) -> int:
        """
        Above 1, the last coordinate takes so many evenly spaced values; else it takes any: a number in [0, 64]. Groups of 16 samples share a value
        """
    @levels.setter
    def levels(self, value: int) -> None:
        ...
    @property
    def max_evaluations(self) -> int:
        """
        No generation begins at or beyond this number of evaluations: a number of at least 1
        """
    @max_evaluations.setter
    def max_evaluations(self, value: int) -> None:
        ...
    @property
    def min_gain(self) -> float:
        """
        The search stops when four generations have gained less than this share of the energy; 0 = never: a number of at least 0
        """
    @min_gain.setter
    def min_gain(self, value: float) -> None:
        ...
    @property
    def population(self) -> int:
        """
        Number of samples in a generation: a number in [4, 4096]. Two groups of 16 fill the lanes of two threads
        """
    @population.setter
    def population(self, value: int) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the random numbers: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
class GenerationRow:
    """
    One generation of one part.
    """
    @property
    def best(self) -> float:
        """
        lowest energy so far
        """
    @property
    def deviation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) standard deviation of the search along each axis
        """
    @property
    def evaluations(self) -> int:
        """
        so far
        """
    @property
    def generation(self) -> int:
        """
        from 0
        """
    @property
    def generation_best(self) -> float:
        """
        lowest energy of this generation
        """
    @property
    def mean(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) the optimiser's answer so far, in [0, 1]
        """
    @property
    def part(self) -> int:
        """
        of the objective
        """
    @property
    def seconds(self) -> float:
        """
        s since the start, earlier runs of a resumed one included
        """
class MinimiseResult:
    """
    Where all optimisers ended, and the way there.
    """
    @property
    def log(self) -> list[GenerationRow]:
        """
        GenerationRows
        """
    @property
    def parts(self) -> list[OptimizerResult]:
        """
        OptimizerResult of each part
        """
    @property
    def penalties(self) -> list[float]:
        """
        (parts) added for each unit of squared distance from the box
        """
    @property
    def seconds(self) -> float:
        """
        s, earlier runs of a resumed one included
        """
class Objective:
    """
    Swap point: energies of a whole generation in one call.
    """
    def __init__(self) -> None:
        ...
    def evaluate(self, samples: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"], context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        samples (S, parts * n) in [0, 1] -> energies (S, parts)
        """
    def parameter_count(self) -> int:
        """
        n, of one part.
        """
    def part_count(self) -> int:
        """
        Independent parts, each with n parameters and an energy of its own.
        """
class MinimiseOptions:
    """
    Options of minimise.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    def __copy__(self) -> MinimiseOptions:
        ...
    def __deepcopy__(self, memo: dict) -> MinimiseOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, seed: int = 1, penalty: float = 16.0, relative_penalty: bool = True, expected_evaluations: int = 512, budget: int = 0, checkpoint: os.PathLike | str | bytes = ..., make_optimizer: collections.abc.Callable[[int, int], Optimizer] | None = ..., on_generation: collections.abc.Callable[[MinimiseResult], None] = ..., problem: str = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def budget(self) -> int:
        """
        Number of evaluations at which the optimisers stop; 0 = not known: a number of at least 0
        """
    @budget.setter
    def budget(self, value: int) -> None:
        ...
    @property
    def checkpoint(self) -> pathlib.Path:
        """
        written after every generation, read at the start if it is there; empty = none
        """
    @checkpoint.setter
    def checkpoint(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def expected_evaluations(self) -> int:
        """
        Expected number of evaluations, for the progress bar and the time left only: a number of at least 1
        """
    @expected_evaluations.setter
    def expected_evaluations(self, value: int) -> None:
        ...
    @property
    def make_optimizer(self) -> collections.abc.Callable[[int, int], Optimizer] | None:
        """
        make_optimizer(dimension, seed) -> Optimizer; None = CMA-ES. Cannot be read back.
        """
    @make_optimizer.setter
    def make_optimizer(self, value: collections.abc.Callable[[int, int], Optimizer] | None) -> None:
        ...
    @property
    def on_generation(self) -> collections.abc.Callable[[MinimiseResult], None]:
        """
        called with the MinimiseResult so far
        """
    @on_generation.setter
    def on_generation(self, value: collections.abc.Callable[[MinimiseResult], None]) -> None:
        ...
    @property
    def penalty(self) -> float:
        """
        Weight omega: energy(clamped sample) + omega scale |sample - clamped|^2: a number of at least 0
        """
    @penalty.setter
    def penalty(self, value: float) -> None:
        ...
    @property
    def problem(self) -> str:
        """
        what the checkpoint belongs to; that of another is not used
        """
    @problem.setter
    def problem(self, value: str) -> None:
        ...
    @property
    def relative_penalty(self) -> bool:
        """
        Scale of the penalty is the median energy of the first generation. Off = 1, the paper's
        """
    @relative_penalty.setter
    def relative_penalty(self, value: bool) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the search; part r gets seed + r: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
class Posterior:
    """
    How likely every answer is: draws from a Gibbs posterior.
    """
    @property
    def correlation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n) of the draws
        """
    @property
    def draws(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (D, n) box units
        """
    @property
    def interval(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, 2) the shortest interval with 90 % of the draws, box units
        """
class EnergyOptions:
    """
    Options of the energy E_fit.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    @staticmethod
    def paper() -> EnergyOptions:
        """
        The settings of the paper.
        """
    def __copy__(self) -> EnergyOptions:
        ...
    def __deepcopy__(self, memo: dict) -> EnergyOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, dt: float = 0.025, alpha: float = 1.0, beta: float = 1.0, gamma: float = 1.0, delta: float = 1.0, fixed_correspondences: bool = True, settle_frames: int = 20, rim_cap: float = 0.064, feature_cap: float = 0.032, speed_dependent_cap: bool = True, outline_size: int = 251, field_size: int = 502, window: int = 0, window_lead: int = 8) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def alpha(self) -> float:
        """
        Weight of E_sil, simulated rims that are not seen: a number of at least 0. 1 is the paper's
        """
    @alpha.setter
    def alpha(self, value: float) -> None:
        ...
    @property
    def beta(self) -> float:
        """
        Weight of E_sift, features in another place: a number of at least 0. 10 is the paper's; more prefers cloth that is too stiff to fold over folds in other places
        """
    @beta.setter
    def beta(self, value: float) -> None:
        ...
    @property
    def delta(self) -> float:
        """
        Weight of E_surf, the distance of the simulated cloth from the captured surface: a number of at least 0. 0 = images alone, the paper's
        """
    @delta.setter
    def delta(self, value: float) -> None:
        ...
    @property
    def dt(self) -> float:
        """
        s, Duration of one video frame: a number above 0
        """
    @dt.setter
    def dt(self, value: float) -> None:
        ...
    @property
    def feature_cap(self) -> float:
        """
        Largest feature distance that counts, as a share of the larger image side: a number above 0. 32 px at 1004, 3 m/s at 2.4 mm a pixel and 40 fps: a mismatch costs every material the same
        """
    @feature_cap.setter
    def feature_cap(self, value: float) -> None:
        ...
    @property
    def field_size(self) -> int:
        """
        Number of nodes that would span the larger side of a distance field: a number of at least 16
        """
    @field_size.setter
    def field_size(self, value: int) -> None:
        ...
    @property
    def fixed_correspondences(self) -> bool:
        """
        Every sample is compared with all that the captured cloth shows. Off = with what the sample itself shows (the paper's): then showing nothing is free
        """
    @fixed_correspondences.setter
    def fixed_correspondences(self, value: bool) -> None:
        ...
    @property
    def gamma(self) -> float:
        """
        Weight of E_con, seen rims that are not simulated: a number of at least 0. 1 = as E_sil, 0 = the paper's
        """
    @gamma.setter
    def gamma(self, value: float) -> None:
        ...
    @property
    def outline_size(self) -> int:
        """
        px, Larger side of the views in which outline and visibility are decided: a number of at least 16
        """
    @outline_size.setter
    def outline_size(self, value: int) -> None:
        ...
    @property
    def rim_cap(self) -> float:
        """
        Largest rim distance that counts, as a share of the larger image side: a number above 0. 64 px at 1004: one lost fold must not rule
        """
    @rim_cap.setter
    def rim_cap(self, value: float) -> None:
        ...
    @property
    def settle_frames(self) -> int:
        """
        Frames in which the cloth falls into place in the first pose before the first counts: a number of at least 0. Half a second, for a hem to come to rest
        """
    @settle_frames.setter
    def settle_frames(self, value: int) -> None:
        ...
    @property
    def speed_dependent_cap(self) -> bool:
        """
        A confirmed feature costs up to its displacement plus half of feature_cap, if that is more. Else cloth that stands still where the film's flies costs no more than cloth that is a little slow
        """
    @speed_dependent_cap.setter
    def speed_dependent_cap(self, value: bool) -> None:
        ...
    @property
    def window(self) -> int:
        """
        Frames of the windows that the motion is cut into; 0 = one rollout: a number of at least 0. Each begins at the captured surface and its speed: over a long rollout chaos outgrows the material
        """
    @window.setter
    def window(self, value: int) -> None:
        ...
    @property
    def window_lead(self) -> int:
        """
        Frames that are simulated before a window counts: a number of at least 0. The captured surface is not at rest under any material
        """
    @window_lead.setter
    def window_lead(self, value: int) -> None:
        ...
class ParameterSpace:
    """
    Which material parameters are searched.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    @staticmethod
    def paper() -> ParameterSpace:
        """
        The settings of the paper.
        """
    def __copy__(self) -> ParameterSpace:
        ...
    def __deepcopy__(self, memo: dict) -> ParameterSpace:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, names: collections.abc.Sequence[str] = ..., fixed: Material = ..., warp_parameters: bool = True) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def material(self, unit: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> Material:
        """
        The Material at a point (n) of the box.
        """
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    def unit(self, material: Material) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n) the point of the box at which a material lies.
        """
    @property
    def fixed(self) -> Material:
        """
        Material that gives the parameters that are not searched
        """
    @fixed.setter
    def fixed(self, value: Material) -> None:
        ...
    @property
    def names(self) -> list[str]:
        """
        Names of the material parameters that are searched: one of 'd_n', 'd_t', 'k_bend', 'k_stretch', 'k_friction', 'k_damping'
        """
    @names.setter
    def names(self, value: collections.abc.Sequence[str]) -> None:
        ...
    @property
    def warp_parameters(self) -> bool:
        """
        The search goes in steps that change the cloth about equally; off = the box itself. drag = 32 u^2, k_stretch = 1 - (1 - u)^4; the paper searches the box
        """
    @warp_parameters.setter
    def warp_parameters(self, value: bool) -> None:
        ...
class MaterialObjective(Objective):
    """
    E_fit of Sect. 6.2 over the box of the parameter space.
    """
    @typing.overload
    def __init__(self, simulator: CharacterSimulator, performance: ReferencePerformance, observations: Observations, options: EnergyOptions = ..., space: ParameterSpace = ..., context: Context = ...) -> None:
        ...
    @typing.overload
    def __init__(self, widths: list, performance: ReferencePerformance, observations: Observations, options: EnergyOptions = ..., space: ParameterSpace = ..., context: Context = ...) -> None:
        ...
    def energies(self, materials: collections.abc.Sequence[collections.abc.Sequence[Material]], context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (S, regions) pixels^2 of materials[sample][region], on all threads
        """
    def surface_energy(self, surfaces: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]]) -> list[float]:
        """
        (regions) E_fit of such surfaces, pixels^2
        """
    def surface_terms(self, surfaces: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]]) -> list:
        """
        The same of surfaces (T, V, 3) that were not simulated, e.g. the captured ones
        """
    def terms(self, materials: collections.abc.Sequence[Material]) -> list:
        """
        One rollout of one material a region -> one dict a region of arrays (T): silhouette, feature, contour and surface (E_sil, E_sift, E_con and E_surf, pixels^2), rims, features, points and probes (how many)
        """
    @property
    def fingerprint(self) -> str:
        """
        hash of everything the energy depends on
        """
    @property
    def space(self) -> ParameterSpace:
        """
        ParameterSpace: which parameters are searched
        """
    @property
    def width_count(self) -> int:
        """
        widths of the garment to choose from
        """
    @property
    def worst_energy(self) -> float:
        """
        pixels^2: no sample costs more
        """
class FitFinding:
    """
    What is doubtful about a parameter of an answer.
    """
    def __init__(self, kind: str, parameter: str, value: float, low: float, high: float) -> None:
        ...
    def text(self) -> str:
        """
        One sentence.
        """
    @property
    def high(self) -> float:
        """
        upper bound, as `low`
        """
    @property
    def kind(self) -> str:
        """
        'lower_bound', 'upper_bound', 'guess' or 'seeds'
        """
    @property
    def low(self) -> float:
        """
        bounds: of the box; a guess: of its 90 % interval; seeds: of the answers
        """
    @property
    def parameter(self) -> str:
        """
        its name
        """
    @property
    def value(self) -> float:
        """
        the answer
        """
class FitOptions:
    """
    Options of estimate_material.
    """
    __hash__: typing.ClassVar[None] = None
    @staticmethod
    def described() -> dict:
        """
        Name -> {unit, meaning, why, takes} of every option in order, and lower and upper, or choices, where it has them.
        """
    @staticmethod
    def paper() -> FitOptions:
        """
        The settings of the paper.
        """
    def __copy__(self) -> FitOptions:
        ...
    def __deepcopy__(self, memo: dict) -> FitOptions:
        ...
    def __eq__(self, other: object) -> bool:
        ...
    def __getstate__(self) -> dict:
        ...
    def __init__(self, *, seed: int = 1, seeds: int = 1, max_evaluations: int = 512, population: int = 0, initial_design_size: int = 64, min_gain: float = 0.02, initial_sigma: float = 0.3, min_deviation: float = 0.025, stagnation: float = 0.0, penalty: float = 16.0, relative_penalty: bool = True, optimizer: typing.Literal['bayesian', 'cma-es', 'annealing'] = 'bayesian', space: ParameterSpace = ..., energy: EnergyOptions = ..., checkpoint: os.PathLike | str | bytes = ..., log: os.PathLike | str | bytes = ..., make_optimizer: collections.abc.Callable[[int, int], Optimizer] | None = ..., on_generation: collections.abc.Callable[[...], None] = ...) -> None:
        """
        Every field may be given by keyword.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, state: dict) -> None:
        ...
    def to_dict(self) -> dict:
        """
        Name -> value of every option.
        """
    @property
    def checkpoint(self) -> pathlib.Path:
        """
        a killed run goes on from it, to the same bits; empty = none
        """
    @checkpoint.setter
    def checkpoint(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def energy(self) -> EnergyOptions:
        """
        Options of E_fit
        """
    @energy.setter
    def energy(self, value: EnergyOptions) -> None:
        ...
    @property
    def initial_design_size(self) -> int:
        """
        Number of materials, spread evenly over the box, with which the Bayesian search begins: a number in [4, 4096]. Three of four do not stretch, as hardly any cloth does; groups of 16 share a width
        """
    @initial_design_size.setter
    def initial_design_size(self, value: int) -> None:
        ...
    @property
    def initial_sigma(self) -> float:
        """
        Standard deviation with which CMA-ES and annealing start, in box units: a number above 0
        """
    @initial_sigma.setter
    def initial_sigma(self, value: float) -> None:
        ...
    @property
    def log(self) -> pathlib.Path:
        """
        fit_log.csv, rewritten after every generation; empty = none
        """
    @log.setter
    def log(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def make_optimizer(self) -> collections.abc.Callable[[int, int], Optimizer] | None:
        """
        make_optimizer(dimension, seed) -> Optimizer; None = the one that `optimizer` names. Cannot be read back.
        """
    @make_optimizer.setter
    def make_optimizer(self, value: collections.abc.Callable[[int, int], Optimizer] | None) -> None:
        ...
    @property
    def max_evaluations(self) -> int:
        """
        No generation begins at or beyond this number of evaluations: a number of at least 1. 512 is the paper's
        """
    @max_evaluations.setter
    def max_evaluations(self, value: int) -> None:
        ...
    @property
    def min_deviation(self) -> float:
        """
        CMA-ES stops when all standard deviations are below this, in box units: a number of at least 0. 0.025 is the paper's
        """
    @min_deviation.setter
    def min_deviation(self, value: float) -> None:
        ...
    @property
    def min_gain(self) -> float:
        """
        The Bayesian search stops when four generations have gained less than this share; 0 = never: a number of at least 0
        """
    @min_gain.setter
    def min_gain(self, value: float) -> None:
        ...
    @property
    def on_generation(self) -> collections.abc.Callable[[...], None]:
        """
        called with the FitResult so far, after every generation
        """
    @on_generation.setter
    def on_generation(self, value: collections.abc.Callable[[...], None]) -> None:
        ...
    @property
    def optimizer(self) -> str:
        """
        Method: bayesian, cma-es (the paper's) or annealing (the paper's comparison): one of 'bayesian', 'cma-es', 'annealing'
        """
    @optimizer.setter
    def optimizer(self, value: str) -> None:
        ...
    @property
    def penalty(self) -> float:
        """
        Weight omega of the penalty for samples outside the box: a number of at least 0. 16 is the paper's
        """
    @penalty.setter
    def penalty(self, value: float) -> None:
        ...
    @property
    def population(self) -> int:
        """
        Number of samples in a generation; 0 = 32, of CMA-ES Hansen's 4 + floor(3 ln n): a number of at least 0. 8 for five parameters, 9 for six
        """
    @population.setter
    def population(self, value: int) -> None:
        ...
    @property
    def relative_penalty(self) -> bool:
        """
        The penalty is omega times the median energy of the first generation. Off = omega alone, the paper's
        """
    @relative_penalty.setter
    def relative_penalty(self, value: bool) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        Seed of the search; region r of R in search k uses seed + k R + r: a number of at least 0
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
    @property
    def seeds(self) -> int:
        """
        Number of searches with seeds of their own; the lowest energy is the answer: a number of at least 1
        """
    @seeds.setter
    def seeds(self, value: int) -> None:
        ...
    @property
    def space(self) -> ParameterSpace:
        """
        Parameters that are searched
        """
    @space.setter
    def space(self, value: ParameterSpace) -> None:
        ...
    @property
    def stagnation(self) -> float:
        """
        CMA-ES stops when best and median energy change by less than this share; 0 = never: a number of at least 0. Those of ten generations against the ten before
        """
    @stagnation.setter
    def stagnation(self, value: float) -> None:
        ...
class Take:
    """
    One film of a character: simulators (one a width of its garment), what was captured and seen.
    """
    def __init__(self, widths: list, performance: typing.Any, observations: typing.Any, dt: float = 0.025) -> None:
        ...
class FitResult:
    """
    The estimated material of every region.
    """
    def at_positions(self, positions: collections.abc.Sequence[float]) -> FitResult:
        """
        The same for a garment whose positions the widths of a take were (see common_widths).
        """
    def to_dict(self) -> dict:
        """
        Everything as plain values.
        """
    @property
    def chosen_widths(self) -> list[float]:
        """
        position of the garment's width, one a region; may be empty
        """
    @property
    def interrupted(self) -> bool:
        """
        the search was not over: the materials are the best samples so far
        """
    @property
    def log(self) -> list[GenerationRow]:
        """
        GenerationRows; part = region
        """
    @property
    def materials(self) -> list[Material]:
        """
        one a region
        """
    @property
    def seconds(self) -> float:
        """
        s, earlier runs of a resumed one included
        """
    @property
    def solver(self) -> SolverSettings:
        """
        SolverSettings, without which the materials mean nothing
        """
class Results:
    """
    What the stages have written into a folder, read when it is asked for.
    """
    def __init__(self, out: os.PathLike | str | bytes) -> None:
        ...
    def body(self) -> BodyFit:
        """
        BodyFit under the clothes.
        """
    def dressed_performance(self) -> ReferencePerformance:
        """
        ReferencePerformance of the dressed actor, whatever the width.
        """
    def forget(self) -> None:
        """
        After files were written: what was read before is read again.
        """
    def observations(self) -> Observations:
        """
        Observations of the film.
        """
    def path(self, file: str) -> pathlib.Path:
        """
        of a file of the folder
        """
    def performance(self) -> ReferencePerformance:
        """
        ReferencePerformance of the actor.
        """
    def proxies(self) -> list[TaperedCapsule]:
        """
        TaperedCapsules of the body.
        """
    def segmentation(self) -> Segmentation:
        """
        Segmentation of the actor.
        """
    def set_widths(self, positions: collections.abc.Sequence[float]) -> None:
        """
        The garment at these positions among its widths, until forget(), whatever material.json says.
        """
    def simulator(self, cloth: ClothOptions = ...) -> CharacterSimulator:
        """
        CharacterSimulator of `dressed`.
        """
    def take(self, solver: SolverSettings, garments: collections.abc.Sequence[Garment] = []) -> Take:
        """
        The Take that the material is estimated from, in each of these widths; none = in all that the garment offers.
        """
    @property
    def actor(self) -> RiggedMesh:
        """
        RiggedMesh
        """
    @property
    def dressed(self) -> DressedActor:
        """
        DressedActor, which is simulated: the actor in `garment`
        """
    @property
    def garment(self) -> Garment:
        """
        Garment in the width that was estimated with the material, or else in the middle one
        """
    @property
    def offered_garment(self) -> Garment:
        """
        Garment as the mesher made it, in several widths to choose from
        """
class Implausible(Error):
    pass
class Limit:
    """
    Of a number in a stage's summary; too low if `impossible` is below `doubtful`, otherwise too high.
    """
    def check(self, value: float) -> Finding | None:
        """
        The Finding; None if the number is as it should be.
        """
    def passed(self, value: float) -> str:
        """
        That the number is as it should be, in words; empty if it is not.
        """
    @property
    def doubtful(self) -> float:
        """
        beyond it the number is doubtful
        """
    @property
    def impossible(self) -> float:
        """
        beyond it nothing should be built on it
        """
    @property
    def number(self) -> str:
        """
        name in the summary
        """
    @property
    def stage(self) -> str:
        """
        whose summary
        """
class RunRecord:
    """
    run.json: what was run, on what, with which options, how long it took.
    """
    def __init__(self, out: os.PathLike | str | bytes) -> None:
        ...
    def begin(self, stage: str, inputs: collections.abc.Mapping[str, str], options: dict) -> None:
        """
        The stage runs from here.
        """
    def end(self, stage: str, summary: dict, outputs: collections.abc.Sequence[str]) -> None:
        """
        It is done.
        """
    def foreign_outputs(self, stage: str, outputs: collections.abc.Sequence[str]) -> list[str]:
        """
        Outputs that exist but are not what this program last wrote.
        """
    def hash(self, path: os.PathLike | str | bytes) -> str:
        """
        SHA-256 of a file, or of all that is in a folder.
        """
    def is_done(self, stage: str) -> bool:
        """
        Did it run to its end?
        """
    def reason_to_run(self, stage: str, inputs: collections.abc.Mapping[str, str], options: dict, outputs: collections.abc.Sequence[str]) -> str:
        """
        Why the stage must run, in words; empty if it is up to date.
        """
    def summary(self, stage: str) -> typing.Any:
        """
        The numbers of a stage; empty if it did not run.
        """
    @property
    def data(self) -> typing.Any:
        """
        all of it, as plain values
        """
    @property
    def path(self) -> pathlib.Path:
        """
        of run.json
        """
class ReconstructionOptions:
    """
    Every option of a reconstruction: options[group], of the names in `groups`, and a few of all.
    """
    groups: typing.ClassVar[tuple] = ('template', 'silhouette', 'key', 'background', 'capture', 'features', 'pose', 'limbs', 'annealing', 'surface', 'calibration', 'segment', 'opposite', 'body', 'proxy', 'garment', 'cloth', 'fit', 'energy', 'space', 'texture')
    @staticmethod
    def is_derived(group: str, name: str) -> bool:
        """
        Is an option of a group set by the session or by `seed`, not by itself?
        """
    def __getitem__(self, group: str) -> typing.Any:
        """
        The options object itself: what is set in it counts.
        """
    def __init__(self) -> None:
        ...
    def __setitem__(self, group: str, options: typing.Any) -> None:
        """
        With the groups that are part of it.
        """
    @property
    def body_model(self) -> pathlib.Path:
        """
        file of the statistical body
        """
    @body_model.setter
    def body_model(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def configuration(self) -> pathlib.Path:
        """
        the file that the options are from; empty = none
        """
    @configuration.setter
    def configuration(self, value: os.PathLike | str | bytes) -> None:
        ...
    @property
    def fps(self) -> float:
        """
        of the videos; 0 = as the session says
        """
    @fps.setter
    def fps(self, value: float) -> None:
        ...
    @property
    def keep_going(self) -> bool:
        """
        past results that cannot be true
        """
    @keep_going.setter
    def keep_going(self, value: bool) -> None:
        ...
    @property
    def seed(self) -> int:
        """
        of every random choice
        """
    @seed.setter
    def seed(self, value: int) -> None:
        ...
class Reconstruction:
    """
    From a capture session to an animatable character, in stages.
    """
    def __init__(self, session: os.PathLike | str | bytes, out: os.PathLike | str | bytes, options: ReconstructionOptions = ..., context: Context = ...) -> None:
        ...
    def fit_options(self) -> FitOptions:
        """
        FitOptions with seed and frame rate.
        """
    def path(self, file: str) -> pathlib.Path:
        """
        of a file of `out`
        """
    def replace(self, stage: str, run: collections.abc.Callable, runner: str | None = None) -> None:
        """
        Puts run(reconstruction), which returns numbers for run.json, in the place of a stage's work; it must write the same files. runner: its name, for the record.
        """
    def reread_session(self) -> None:
        """
        After its files were changed.
        """
    def run(self, names: collections.abc.Sequence[str], force: bool = False) -> bool:
        """
        Stages by name, each unless it is up to date. Returns whether any ran.
        """
    def run_all(self, force: bool = False) -> bool:
        """
        All stages, each unless it is up to date.
        """
    def solver_settings(self) -> SolverSettings:
        """
        SolverSettings, without which materials mean nothing.
        """
    @property
    def announce(self) -> collections.abc.Callable[[str], None]:
        """
        called with one line about each stage
        """
    @announce.setter
    def announce(self, value: collections.abc.Callable[[str], None]) -> None:
        ...
    @property
    def context(self) -> Context:
        """
        Context, whose log is also in log.txt
        """
    @property
    def filmed(self) -> Session:
        """
        the session with the refined cameras, if there are any
        """
    @property
    def findings(self) -> list[Finding]:
        """
        what the stages that were asked for found doubtful
        """
    @property
    def options(self) -> ReconstructionOptions:
        """
        ReconstructionOptions
        """
    @options.setter
    def options(self, value: ReconstructionOptions) -> None:
        ...
    @property
    def out(self) -> pathlib.Path:
        """
        folder of the results
        """
    @property
    def record(self) -> RunRecord:
        """
        RunRecord
        """
    @property
    def results(self) -> Results:
        """
        Results of the stages
        """
    @property
    def session(self) -> Session:
        """
        Session, read when it is asked for
        """
    @session.setter
    def session(self, value: Session) -> None:
        ...
    @property
    def session_folder(self) -> pathlib.Path:
        """
        as it was given
        """
    @property
    def silhouettes(self) -> SilhouetteExtractor:
        """
        trained SilhouetteExtractor; None if all cameras have ready masks
        """
    @property
    def stages(self) -> list[Stage]:
        """
        Stages in their order; a list of its own, to be set as a whole
        """
    @stages.setter
    def stages(self, value: collections.abc.Sequence[Stage]) -> None:
        ...
class Stage:
    """
    What reads and writes files of a reconstruction's folder.
    """
    def __init__(self, name: str, run: collections.abc.Callable, *, reads: collections.abc.Sequence[str] = [], writes: collections.abc.Sequence[str] = [], may_read: collections.abc.Sequence[str] = [], option_groups: collections.abc.Sequence[str] = [], session_inputs: collections.abc.Sequence[str] = [], needs_scan: bool = True) -> None:
        """
        run(reconstruction) does the work and returns the numbers worth recording.
        """
    def run(self, reconstruction: Reconstruction) -> typing.Any:
        """
        Does the work, whatever is up to date -> the numbers worth recording.
        """
    @property
    def continues_from(self) -> list[str]:
        """
        files of it that a stage that was stopped goes on from
        """
    @property
    def may_read(self) -> list[str]:
        """
        files of the folder that count as inputs if they are there
        """
    @property
    def name(self) -> str:
        """
        of the stage
        """
    @property
    def option_groups(self) -> list[str]:
        """
        that its results depend on
        """
    @property
    def reads(self) -> list[str]:
        """
        files of the folder
        """
    @property
    def runner(self) -> str:
        """
        whose work it is; empty = doublet's
        """
    @property
    def session_inputs(self) -> list[str]:
        """
        description, scan, calibration, joints, images
        """
    @property
    def writes(self) -> list[str]:
        """
        files of the folder
        """
def align_scan(scan: Mesh, hull: Mesh, context: Context = ...) -> AlignedScan:
    """
    A scan in any unit, upright along any axis, brought to the hull that the cameras see (scan_from_views) -> AlignedScan.
    """
def animate(character: Character, motion: Motion, options: AnimateOptions = ..., context: Context = ..., make_solver: collections.abc.Callable[[ClothModel], ClothSolver] | None = None) -> AnimationResult:
    """
    The whole animation in memory. The motion is resampled to the character's own rate. Raises Error naming the frame if the simulation leaves the finite numbers. make_solver: as of CharacterSimulator.
    """
def animate_each(character: Character, motion: Motion, frame: collections.abc.Callable[[AnimationFrame], None], options: AnimateOptions = ..., context: Context = ..., make_solver: collections.abc.Callable[[ClothModel], ClothSolver] | None = None) -> int:
    """
    animate(), but calls frame(AnimationFrame) in order and keeps nothing.
    """
def apply_corrections(pose: Mesh, face_valid: numpy.typing.ArrayLike, found: Segmentation, painted: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"]) -> Segmentation:
    """
    What was found, with a person's corrections: painted (V) is -1 as found, 0 skin, 1 cloth, 2 a border between regions.
    """
def body_fitter_violations(fitter: BodyFitter, actor: RiggedMesh, segmentation: Segmentation, model: BodyModel, landmarks: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]]) -> list[str]:
    """
    One sentence for each rule that a BodyFitter breaks on a scan of yours: sizes, finite, the same bits twice, refusals.
    """
def body_model_violations(model: BodyModel) -> list[str]:
    """
    One sentence for each rule that a BodyModel breaks: counts, indices, derivatives, the same bits twice, refusals.
    """
def body_regions(fit: BodyFit, actor: RiggedMesh, segmentation: Segmentation) -> list[BodyRegion]:
    """
    One BodyRegion a bone: how far the fit can be trusted there.
    """
def build_display_mesh(actor: RiggedMesh, segmentation: Segmentation, high: Mesh) -> DisplayMesh:
    """
    The scan's surface as it is drawn; where the actor wears a garment with a mesh of its own, that takes its place.
    """
def build_template(scan: Mesh, options: TemplateOptions = ..., context: Context = ...) -> Template:
    """
    The closed surface of a scan, its two decimations and the faces that were invented over holes.
    """
def canonical_frames(actor: RiggedMesh, performance: ReferencePerformance, context: Context = ...) -> numpy.typing.NDArray[numpy.float64]:
    """
    (T, V, 3) m: the captured frames, taken back to the scan pose by the skeleton.
    """
def capsule_mesh(p0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], p1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], r0: float, r1: float) -> Mesh:
    """
    Closed triangle mesh of a tapered capsule: spheres at p0 and p1, m, and the cone between them.
    """
def check_session(session: Session, frames: FrameSource, extractor: SilhouetteExtractor | None = None, context: Context = ...) -> SessionCheck:
    """
    Whether a session can be true: scan, joints, calibration, frame rates and silhouettes against each other -> SessionCheck.
    """
def choose_widths(garment: Garment, chosen: collections.abc.Sequence[float] = []) -> Garment:
    """
    The garment in the widths that were chosen, a position (0 = the first, 0.5 = halfway to the second) a region; without, in its `rest`.
    """
def cloth_prior(actor: RiggedMesh, pose: Mesh) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    (V) log odds of loose cloth by place on the body: below 0 on hands, feet, head, and what hangs on no trunk.
    """
def cloth_segmenter_violations(segmenter: ClothSegmenter) -> list[str]:
    """
    One sentence for each rule that a ClothSegmenter breaks: sizes, ranges, regions, the same bits twice, refusals.
    """
def cloth_solver_violations(make_solver: collections.abc.Callable[[ClothModel], ClothSolver] | None) -> list[str]:
    """
    One sentence for each rule that the solvers of make_solver(model) break; of None, ours: the rest state rests, cloth falls, pinned vertices obey, a copied state replays, company and threads change nothing, the corners of the material box stay finite, wrong input is refused.
    """
def common_widths(garments: collections.abc.Sequence[Garment], count: int) -> list[list[float]]:
    """
    [garments][count] positions at which several meshes of one garment have the same area at rest, the widest first.
    """
def create_bayesian(dimension: int, options: BayesianOptions = ...) -> Optimizer:
    """
    Bayesian optimisation by Thompson sampling over [0, 1]^dimension: for energies that are expensive and noisy.
    """
def create_cma_es(dimension: int, options: CmaEsOptions = ...) -> Optimizer:
    """
    Covariance matrix adaptation (Hansen) over [0, 1]^dimension.
    """
def create_simulated_annealing(dimension: int, options: AnnealingOptions = ...) -> Optimizer:
    """
    Independent Metropolis chains under one geometric cooling schedule, over [0, 1]^dimension.
    """
def default_stages() -> list[Stage]:
    """
    The stages of a reconstruction, in their order.
    """
def detect_joints(surface: Mesh, face_valid: numpy.typing.ArrayLike, model: BodyModel, options: BodyFitOptions = ..., seen: collections.abc.Mapping[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]] = {}, context: Context = ...) -> DetectedJoints:
    """
    Joints and landmarks of a person, upright (+Y), by the body model. face_valid: 0 = invented, empty = all valid; seen: joints whose places are known to 3 cm, name -> (3) m; without them arms and legs must be apart.
    """
def distances_to_surface(points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], surface: Mesh, face_valid: numpy.typing.ArrayLike = [], context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    (N) unsigned distances, m
    """
@typing.overload
def dress(actor: RiggedMesh, segmentation: Segmentation, garment: Garment) -> DressedActor:
    """
    The actor in the garment.
    """
@typing.overload
def dress(performance: ReferencePerformance, actor: RiggedMesh, garment: Garment) -> ReferencePerformance:
    """
    The captured surface on the dressed actor's mesh.
    """
def dual_quaternion_skinning(rest: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], weights: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"], world_from_rest: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (V, 3) the rest positions (V, 3), carried by transforms (J, 4, 4) with weights (V, J).
    """
@typing.overload
def estimate_material(takes: collections.abc.Sequence[Take], options: FitOptions = ..., context: Context = ...) -> FitResult:
    """
    The material, and the width of the garment, under which several takes are explained together -> FitResult.
    """
@typing.overload
def estimate_material(simulator: CharacterSimulator, performance: ReferencePerformance, observations: Observations, options: FitOptions = ..., context: Context = ...) -> FitResult:
    """
    Searches the material of every cloth region that makes the simulated character look as in the video -> FitResult. Goes on from options.checkpoint if that is there.
    """
def explain_match(clip: SourceMotion, given: collections.abc.Mapping[str, str] = {}) -> list[JointMatch]:
    """
    A JointMatch for each of our joints. given: our joint -> name in the clip, '' = none.
    """
def face_areas(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    (F) m^2.
    """
def face_normals(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (F, 3) unit; zero for degenerate faces.
    """
def feature_tracker_violations(tracker: FeatureTracker, image: numpy.typing.NDArray[numpy.uint8], mask: numpy.typing.NDArray[numpy.uint8], reach: float) -> list[str]:
    """
    The same of a FeatureTracker, on an image of yours; reach in pixels.
    """
def filmed(session: Session, captured: CaptureResult) -> Session:
    """
    The session with the cameras that a capture of it went by: refined, if they were, and late ones waited for.
    """
def find_contacts(skeleton: Skeleton, motion: Motion, options: PlantOptions = ...) -> list[FootContacts]:
    """
    A FootContacts for each foot of the Motion that can be planted: when its heel and ball stand.
    """
def find_limbs(skeleton: Skeleton) -> list[Limb]:
    """
    The limbs of a skeleton by its topology.
    """
def find_start_frame(scan: Mesh, rig: collections.abc.Sequence[Camera], frames: FrameSource, extractor: SilhouetteExtractor | None = None, context: Context = ...) -> StartFrame:
    """
    Frame 0 if it is in the scan's pose, moved and turned about the vertical, otherwise the frame that comes nearest -> StartFrame.
    """
def findings_to_json(findings: collections.abc.Sequence[Finding]) -> typing.Any:
    """
    What a stage found, as 'findings' of its summary: a list of dicts.
    """
def fit_proxies(fit: BodyFit, actor: RiggedMesh, segmentation: Segmentation, options: ProxyOptions = ...) -> list[TaperedCapsule]:
    """
    Tapered capsules along the bones, inside the body: what cloth collides with.
    """
def fit_together(reconstructions: collections.abc.Sequence[Reconstruction]) -> None:
    """
    One material, and one width, for several takes of one garment, with the options and the seed of the first.
    """
def frame_source_violations(frames: FrameSource) -> list[str]:
    """
    One sentence for each rule that a FrameSource breaks: channels, masks, sizes, the same frame again.
    """
def garment_mesher_violations(mesher: GarmentMesher, actor: RiggedMesh, segmentation: Segmentation) -> list[str]:
    """
    One sentence for each rule that a GarmentMesher breaks on an actor of yours: it fits, the same bits twice, refusals.
    """
def hash_files(path: os.PathLike | str | bytes) -> str:
    """
    SHA-256 of a file in hexadecimal digits; of a folder that of the names and contents of all files in it.
    """
def heat_weights(mesh: Mesh, face_valid: numpy.typing.ArrayLike, skeleton: Skeleton, options: HeatWeightOptions = ..., context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
    """
    (V, J) skin weights by heat equilibrium; rows sum to one.
    """
def hidden_faces(character: Character) -> numpy.typing.NDArray[numpy.bool_]:
    """
    (FH) 1 = a face of M_high that is of the hidden body, or joins it to the scan.
    """
def limb_search_violations(search: LimbSearch, problem: LimbProblem, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], lost: collections.abc.Sequence[Limb]) -> list[str]:
    """
    The same of a LimbSearch, on a problem, a pose within the limits and limbs that are lost.
    """
def make_character(actor: RiggedMesh, segmentation: Segmentation, body: BodyFit, proxies: collections.abc.Sequence[TaperedCapsule], materials: collections.abc.Sequence[Material], solver: SolverSettings, high: Mesh = ..., high_valid: numpy.typing.ArrayLike = [], garment_subdivisions: int = -1) -> Character:
    """
    Puts together what a new animation needs; the body takes the actor's weights and is drawn where cloth hides it.
    """
def material_energy(simulator: CharacterSimulator, performance: ReferencePerformance, observations: Observations, materials: collections.abc.Sequence[Material], options: EnergyOptions = ..., context: Context = ...) -> list[float]:
    """
    One E_fit a region, pixels^2, of one material a region.
    """
def measure_observations(rig: collections.abc.Sequence[Camera], frames: FrameSource, extractor: SilhouetteExtractor | None = None, numbers: collections.abc.Sequence[int] = [], tracker: FeatureTracker | None = None, options: FeatureTrackerOptions = ..., context: Context = ...) -> Observations:
    """
    Observations of a take without tracking it, as the capture measures them: outlines of the frames `numbers` (none = all), and, with a FeatureTracker, features matched with the frame before. extractor: trained, for frames without a ready mask.
    """
def mesh_garment(actor: RiggedMesh, segmentation: Segmentation, body: Mesh, captured: MeshSequence, options: GarmentOptions = ..., context: Context = ...) -> Garment:
    """
    All cloth of the actor as a mesh of its own, in one call.
    """
def minimise(objective: Objective, options: MinimiseOptions = ..., context: Context = ...) -> MinimiseResult:
    """
    Runs one optimiser a part of the objective until all stop. Goes on from options.checkpoint if it is there and belongs to options.problem; raises Error if it is damaged.
    """
def objective_violations(objective: Objective) -> list[str]:
    """
    One sentence for each rule that an Objective breaks: shapes, finite energies, the same again and in any company, refusals.
    """
def optimizer_violations(make_optimizer: collections.abc.Callable[[int, int], Optimizer] | None) -> list[str]:
    """
    One sentence for each rule that the optimisers of make_optimizer(dimension, seed) break: shapes, seeds, a paraboloid is brought down, refusals.
    """
def orbit_camera(target: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"], radius: float, azimuth: float, elevation: float, width: int, height: int) -> Camera:
    """
    Looks at target from azimuth (rad, 0 = from +Z) and elevation.
    """
def performance_capture_violations(capture: ..., actor: RiggedMesh, rig: collections.abc.Sequence[Camera], frames: FrameSource, extractor: SilhouetteExtractor | None = None) -> list[str]:
    """
    The same of a PerformanceCapture, on a short film of yours, which it captures twice.
    """
def plant_feet(skeleton: Skeleton, motion: Motion, options: PlantOptions = ...) -> Motion:
    """
    The Motion with its feet planted: what stands stays where it is, on the floor, and no foot is below it.
    """
def pose_optimizer_violations(optimizer: PoseOptimizer, problem: PoseProblem) -> list[str]:
    """
    The same of a PoseOptimizer, on a problem that it was given.
    """
def pose_surface(actor: RiggedMesh, dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], offset: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (V, 3) m, skinned positions of the rest pose + offset (V, 3).
    """
def posterior_of(samples: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"], energies: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], noise: float = 0.0, levels: int = 0, draws: int = 256, seed: int = 1) -> Posterior:
    """
    samples (N, n) in [0, 1], energies (N) -> Posterior of where their minimum is. noise: standard deviation of an energy.
    """
def proxy_statistics(capsules: collections.abc.Sequence[TaperedCapsule], fit: BodyFit, actor: RiggedMesh, segmentation: Segmentation) -> ProxyStatistics:
    """
    How far capsules and body are apart under the cloth.
    """
def quality_findings(stage: str, summary: dict) -> list[Finding]:
    """
    What is implausible in the summary of a stage that is done.
    """
def quality_limits() -> list[Limit]:
    """
    Limits of the numbers of all stages.
    """
def rasterize(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], camera: Camera, face_valid: numpy.typing.ArrayLike = []) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float32]]:
    """
    (face, depth): face index at each pixel (-1 = background) and depth in m (inf = background), both (height, width).
    """
def read_actor(path: os.PathLike | str | bytes) -> RiggedMesh:
    """
    actor.npz. Raises FileNotFoundError, or Error naming file and array.
    """
def read_body(path: os.PathLike | str | bytes) -> BodyFit:
    """
    body.npz. Raises FileNotFoundError, or Error naming file and array.
    """
def read_calibration(path: os.PathLike | str | bytes, options: CalibrationOptions = ..., context: Context = ...) -> list[CalibratedCamera]:
    """
    Cameras of OpenCV, COLMAP, EasyMocap, Pose2Sim, Caliscope, anipose, Qualisys, Panoptic Studio or Metashape, or of a calibration.yml, in metres and with +Y up. The context's log says which were left out.
    """
def read_found_segmentation(out: os.PathLike | str | bytes) -> Segmentation:
    """
    The segmentation as it was before anything was painted.
    """
def read_garment(path: os.PathLike | str | bytes, actor: RiggedMesh) -> Garment:
    """
    garment.npz of this actor. Raises FileNotFoundError, or Error naming file and array.
    """
def read_materials(path: os.PathLike | str | bytes, solver: SolverSettings | None = None) -> list[Material]:
    """
    material.json: one Material a region. Raises FileNotFoundError, or Error naming file and parameter, or the setting of the solver that is another than the file's.
    """
def read_mesh(path: os.PathLike | str | bytes) -> Mesh:
    """
    .ply, .obj, .stl or .off: vertices and faces; polygons become fans of triangles. Raises FileNotFoundError, or Error naming the file.
    """
def read_observations(path: os.PathLike | str | bytes) -> Observations:
    """
    observations.npz. Raises FileNotFoundError, or Error naming file and array.
    """
def read_performance(path: os.PathLike | str | bytes, actor: RiggedMesh) -> ReferencePerformance:
    """
    performance.npz of this actor. Raises FileNotFoundError, or Error naming file and array.
    """
def read_proxies(path: os.PathLike | str | bytes, skeleton: Skeleton) -> list[TaperedCapsule]:
    """
    proxies.json of this skeleton. Raises FileNotFoundError, or Error naming file and capsule.
    """
def read_segmentation(path: os.PathLike | str | bytes) -> Segmentation:
    """
    segmentation.npz. Raises FileNotFoundError, or Error naming file and array.
    """
def read_segmentation_paint(out: os.PathLike | str | bytes, vertices: int) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 1]"] | None:
    """
    (V) int32 in -1 to 2, None if nothing was painted.
    """
def read_simulated(path: os.PathLike | str | bytes) -> numpy.typing.NDArray[numpy.float64]:
    """
    simulated.npz: (T, V + G, 3), the actor's vertices, then the garment's.
    """
def read_suggested_mask(out: os.PathLike | str | bytes) -> numpy.typing.NDArray[numpy.bool_]:
    """
    (F) bool of the template in OUT, False: suggested as invalid.
    """
def read_template_mask(out: os.PathLike | str | bytes) -> numpy.typing.NDArray[numpy.bool_]:
    """
    (F) bool: the edited mask if there is one, else the suggestion.
    """
def read_view(frames: FrameSource, camera: int, frame: int, extractor: SilhouetteExtractor | None = None) -> CameraView:
    """
    The image, and the ready mask or, where there is none, the extractor's -> CameraView.
    """
def read_views(session: Session, frame: int, extractor: SilhouetteExtractor | None = None) -> FrameViews:
    """
    Of every camera, as read_view -> FrameViews.
    """
def read_widths(path: os.PathLike | str | bytes) -> list[float]:
    """
    material.json: position of the garment's width, one a region; empty if it names none.
    """
def refine_rest_pose(actor: RiggedMesh, performance: ReferencePerformance, rigid: numpy.typing.ArrayLike, options: RestPoseOptions = ..., context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (V, 3) m: the actor's vertices in the rest pose, those of the skin (rigid (V): 1) where the frames that are bent least have them.
    """
def render(meshes: collections.abc.Sequence[RenderMesh], camera: Camera, options: RenderOptions = ...) -> numpy.typing.NDArray[numpy.uint8]:
    """
    (H, W, 3) uint8, BGR
    """
def require_scanned(session: Session) -> None:
    """
    Raises if the session has no scan or no joints.
    """
def resample(skeleton: Skeleton, motion: Motion, fps: float) -> Motion:
    """
    The same Motion at another rate; first and last pose stay (the last as far as the new rate reaches it).
    """
def resolve_arm_penetration(character: Character, motion: Motion, context: Context = ...) -> Motion:
    """
    The Motion with shoulders turned so far that forearms and hands are clear of the body; animate() does it by default.
    """
def retarget(clip: SourceMotion, skeleton: Skeleton, options: RetargetOptions = ..., context: Context = ...) -> Motion:
    """
    A clip on its own skeleton -> a Motion of ours; joints are matched by name and place.
    """
def rig_template(surface: Template, joints: collections.abc.Sequence[JointAnnotation], context: Context = ...) -> RiggedMesh:
    """
    Skeleton from the marked joints and skin weights -> RiggedMesh.
    """
def sample_colours(mesh: Mesh, face_valid: numpy.typing.ArrayLike, cameras: collections.abc.Sequence[Camera], images: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]], masks: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]] = [], options: TextureOptions = ..., context: Context = ...) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (10 F, 3) B G R, 0 to 255, at 10 points of every face, NaN where no camera sees it: for SegmentInputs.colours.
    """
def scan_from_views(rig: collections.abc.Sequence[Camera], views: collections.abc.Sequence[CameraView], options: ViewScanOptions = ..., context: Context = ..., body: Mesh | None = None) -> Mesh:
    """
    Visual hull of the masks, pressed in where cameras agree -> Mesh, open where it faces down unseen. views: a CameraView a camera, of one frame; body: a fitted one, from which the surface is no farther than the outlines are.
    """
def segment_cloth(sequence: MeshSequence, face_valid: numpy.typing.ArrayLike, options: SegmentOptions = ..., context: Context = ...) -> Segmentation:
    """
    ClothSegmenter.create(options).segment(SegmentInputs(sequence, face_valid), context).
    """
def segment_performance(actor: RiggedMesh, performance: ReferencePerformance, segmenter: ClothSegmenter, colours: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"] | None = None, context: Context = ...) -> Segmentation:
    """
    The whole stage for a captured performance: canonical frames, prior, segmentation. colours of its first frame, as SegmentInputs has them.
    """
def segmentation_pose(actor: RiggedMesh, performance: ReferencePerformance) -> Mesh:
    """
    The first frame if it is in the scan's pose, otherwise the actor's mesh: what a segmentation is made in -> Mesh.
    """
def self_intersecting_faces(mesh: Mesh, context: Context = ...) -> numpy.typing.NDArray[numpy.bool_]:
    """
    (F) 1 for the faces that pass through another face
    """
def session_silhouettes(session: Session, frames: FrameSource, options: SilhouetteOptions = ..., context: Context = ...) -> SilhouetteExtractor:
    """
    A trained extractor for the cameras without ready masks; None if all have some.
    """
def silhouette_extractor_violations(extractor: SilhouetteExtractor, training: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]], image: numpy.typing.NDArray[numpy.uint8]) -> list[str]:
    """
    The same of a SilhouetteExtractor, trained and tried with images of yours.
    """
def simulate_reference(simulator: CharacterSimulator, performance: ReferencePerformance, materials: collections.abc.Sequence[Material], dt: float, settle_frames: int = 20, context: Context = ...) -> numpy.typing.NDArray[numpy.float64]:
    """
    (T, V, 3) the reference motion re-animated
    """
def spring_constant(k: float, response: float) -> float:
    """
    What k_stretch (N/m) or k_bend (N m) is under 'compliance': k / ((1 - k) (1/40 s)^2 response); infinite for k = 1. response: the sum of |grad C|^2 / mass over the vertices of a constraint C: of an edge 1 / m_a + 1 / m_b, 1/kg; of a hinge, whose C is its angle, 1/(kg m^2). The masses of a ClothModel are areas, m^2: times kg/m^2 they are masses.
    """
def step_players(players: collections.abc.Sequence[Player], dofs: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]], seconds: float, threads: int = 1) -> None:
    """
    player.step(pose, seconds) for copies of one player, side by side in the lanes of the processor's registers and on up to `threads` threads, with the same bits; dofs: a pose (D) for each.
    """
def stiffness_of_spring(constant: float, response: float) -> float:
    """
    The k that has this spring constant.
    """
def summarise_garment(garment: Garment) -> GarmentSummary:
    """
    Counts and quality of a garment's mesh.
    """
def summarise_segmentation(pose: Mesh, face_valid: numpy.typing.ArrayLike, segmentation: Segmentation) -> SegmentSummary:
    """
    Areas, noise and how sure a segmentation is.
    """
def summarise_template(surface: Template, scan: Mesh, context: Context = ...) -> TemplateSummary:
    """
    Quality of both surfaces of a template, and their distances to the scan.
    """
def surface_refiner_violations(refiner: SurfaceRefiner, problem: SurfaceProblem) -> list[str]:
    """
    The same of a SurfaceRefiner, on a problem that it was given.
    """
def texture_character(character: Character, surface: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], cameras: collections.abc.Sequence[Camera], images: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]], masks: collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]] = [], options: TextureOptions = ..., context: Context = ...) -> float:
    """
    Gives the character a texture from the images of the frame in which M is at `surface` (V, 3), and its hidden body the colour of the skin beyond the garment's edge; returns the share of its surface that a camera saw.
    """
def texture_character_from_take(character: Character, surfaces: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]], cameras: collections.abc.Sequence[Camera], images: collections.abc.Callable[[int], tuple[collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]], collections.abc.Sequence[numpy.typing.NDArray[numpy.uint8]]]], options: TextureOptions = ..., context: Context = ...) -> float:
    """
    The same from the frames of a take in which M is at `surfaces` (a list of (V, 3)): images(i) gives those of the i-th and its masks, two lists with one a camera; it is asked for few of them, in rising order.
    """
def trace_outline(mask: numpy.typing.NDArray[numpy.uint8], margin: int = 2) -> Outline:
    """
    Boundary of a mask (H, W).
    """
def train_body_model(population: os.PathLike | str | bytes, out: os.PathLike | str | bytes, options: TrainOptions = ..., context: Context = ...) -> TrainSummary:
    """
    Registered meshes (POPULATION.npz) -> statistical body model (MODEL.npz).
    """
def triangulate(cameras: collections.abc.Sequence[CalibratedCamera], seen: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"] | None:
    """
    (3) m: the point that the most cameras agree on, or None if no two do. seen: (C, 3) pixel and confidence in each camera; below 0.3 it does not count.
    """
def vertex_areas(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    (V) m^2, a third of the faces around each vertex.
    """
def vertex_normals(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
    """
    (V, 3) unit, weighted by angle; zero where no face is.
    """
def visible_vertices(vertices: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 3]"], faces: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 3]"], cameras: collections.abc.Sequence[Camera], tolerance: float) -> numpy.typing.NDArray[numpy.bool_]:
    """
    (V) 1 where at least one camera sees the vertex; tolerance in m
    """
def width_variants(garment: Garment) -> list[Garment]:
    """
    The garment in each of the widths that it offers.
    """
def write_actor(path: os.PathLike | str | bytes, actor: RiggedMesh) -> None:
    """
    actor.npz, complete or not at all.
    """
def write_baked_glb(path: os.PathLike | str | bytes, character: Character, animation: AnimationResult, options: BakedGlbOptions = ...) -> int:
    """
    An animation as glTF 2.0 that any viewer plays: bones, and a shape for every key, of M_high in its texture (of M where the animation is without M_high) and of the body. Complete or not at all. Returns the number of keys.
    """
def write_baked_npz(path: os.PathLike | str | bytes, character: Character, animation: AnimationResult) -> None:
    """
    An animation as arrays (docs/formats.md), complete or not at all.
    """
def write_body(path: os.PathLike | str | bytes, fit: BodyFit) -> None:
    """
    body.npz, complete or not at all.
    """
def write_bvh(path: os.PathLike | str | bytes, skeleton: Skeleton, motion: Motion) -> None:
    """
    A Motion as BVH in metres and degrees, +Y up, complete or not at all.
    """
def write_calibration(path: os.PathLike | str | bytes, cameras: collections.abc.Sequence[CalibratedCamera]) -> None:
    """
    calibration.yml of a session, complete or not at all; takes Camera, too.
    """
def write_garment(path: os.PathLike | str | bytes, garment: Garment) -> None:
    """
    garment.npz, complete or not at all.
    """
def write_materials(path: os.PathLike | str | bytes, result: FitResult) -> None:
    """
    material.json, complete or not at all.
    """
def write_mesh(path: os.PathLike | str | bytes, mesh: Mesh) -> None:
    """
    .ply, .obj, .stl or .off by the extension, complete or not at all.
    """
def write_observations(path: os.PathLike | str | bytes, observations: Observations) -> None:
    """
    observations.npz, complete or not at all.
    """
def write_performance(path: os.PathLike | str | bytes, performance: ReferencePerformance) -> None:
    """
    performance.npz, complete or not at all.
    """
def write_proxies(path: os.PathLike | str | bytes, capsules: collections.abc.Sequence[TaperedCapsule], skeleton: Skeleton) -> None:
    """
    proxies.json, complete or not at all.
    """
def write_segmentation(path: os.PathLike | str | bytes, segmentation: Segmentation) -> None:
    """
    segmentation.npz, complete or not at all.
    """
def write_segmentation_paint(out: os.PathLike | str | bytes, painted: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[m, 1]"], vertices: int) -> None:
    """
    Writes what was painted, -1 (as found), 0 (skin), 1 (cloth) or 2 (border) for each vertex.
    """
def write_simulated(path: os.PathLike | str | bytes, frames: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], actor_vertices: int) -> None:
    """
    simulated.npz: frames (T, V + G, 3), of which the first actor_vertices (V) are the actor's, the others the garment's.
    """
def write_template_mask(out: os.PathLike | str | bytes, mask: numpy.typing.ArrayLike) -> None:
    """
    Writes the edited mask (F), 0 or 1 each, for the template in OUT.
    """
def write_template_suggestion(path: os.PathLike | str | bytes, surface: Template) -> None:
    """
    template_suggestion.npz: the masks of both surfaces.
    """
__version__: str = '0.1.0'
