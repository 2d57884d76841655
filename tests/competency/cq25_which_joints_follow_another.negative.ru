# Edit   The right finger of pr2 gets a motor of its own.
# Loses  pr2,right_finger_joint,left_finger_joint,1
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE WHERE { GRAPH ?graph { id:pr2\/joint\/right_finger_joint a sdt:PassiveJoint } }
