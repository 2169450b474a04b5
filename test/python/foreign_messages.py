# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of other packages, from their published definitions as a publisher sends them."""

from genpy.dynamic import generate_dynamic

LINE = "\n" + 80 * "=" + "\nMSG: "
HEADER = LINE + "std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
VECTOR = "float64 x\nfloat64 y\nfloat64 z\n"
QUATERNION = LINE + "geometry_msgs/Quaternion\n" + VECTOR + "float64 w\n"
POSE = (
    LINE + "geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n"
    + LINE + "geometry_msgs/Pose\nPoint position\nQuaternion orientation\n"
    + LINE + "geometry_msgs/Point\n" + VECTOR + QUATERNION
)  # fmt: skip
DEFINITIONS = {
    "apriltag_ros/AprilTagDetectionArray": "std_msgs/Header header\nAprilTagDetection[] detections\n"
    + HEADER + LINE + "apriltag_ros/AprilTagDetection\nint32[] id\nfloat64[] size\n"
    + "geometry_msgs/PoseWithCovarianceStamped pose\n"
    + LINE + "geometry_msgs/PoseWithCovarianceStamped\nHeader header\nPoseWithCovariance pose\n" + POSE,
    "aruco_msgs/MarkerArray": "Header header\naruco_msgs/Marker[] markers\n" + HEADER
    + LINE + "aruco_msgs/Marker\nHeader header\nuint32 id\n"
    + "geometry_msgs/PoseWithCovariance pose\nfloat64 confidence\n" + POSE,
    "fiducial_msgs/FiducialArray": "Header header\nint32 image_seq\nFiducial[] fiducials\n" + HEADER
    + LINE + "fiducial_msgs/Fiducial\nint32 fiducial_id\nint32 direction\n"
    + "".join(f"float64 {axis}{corner}\n" for corner in range(4) for axis in "xy"),
    "fiducial_msgs/FiducialTransformArray": "Header header\nint32 image_seq\nFiducialTransform[] transforms\n"
    + HEADER + LINE + "fiducial_msgs/FiducialTransform\nint32 fiducial_id\n"
    + "geometry_msgs/Transform transform\nfloat64 image_error\nfloat64 object_error\nfloat64 fiducial_area\n"
    + LINE + "geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
    + "geometry_msgs/Quaternion rotation\n" + LINE + "geometry_msgs/Vector3\n" + VECTOR + QUATERNION,
}  # fmt: skip


def classes_of(name):
    """{type: class} of a message and of what it contains, by their short names, and the message itself."""
    classes = generate_dynamic(name, DEFINITIONS[name])
    return classes[name], {key.split("/")[1]: value for key, value in classes.items()}
