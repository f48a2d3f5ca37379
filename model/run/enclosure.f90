!> The chamber of a case: the box of its domain, what the boundaries make of the faces, and the walls within it.
module enclosure
  use case, only: case_t
  use chamber, only: chamber_t
  use covered_faces, only: faces_covered
  use kinds, only: wp
  use mesh_rims, only: wall_within
  use open_faces, only: find_openings, rest_of_face
  use surface, only: surface_t, new_surface
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: enclosure_of

contains

  pure function enclosure_of(case) result(chamber)
    type(case_t), intent(in) :: case
    type(chamber_t) :: chamber

    type(wall_settings_t), allocatable :: walls(:)
    type(surface_t), allocatable :: surfaces(:)
    integer :: b

    chamber%lower = case%domain%lower
    chamber%upper = case%domain%upper
    chamber%periodic = case%domain%periodic
    chamber%gravity = case%domain%gravity
    chamber%face_material = case%contact%wall_material
    do b = 1, size(case%boundaries)
      associate (boundary => case%boundaries(b))
        if (boundary%material > 0) chamber%face_material = merge(boundary%material, chamber%face_material, &
                                                                 reshape(faces_covered(case%domain, boundary), [6]))
      end associate
    end do
    walls = case%walls
    surfaces = case%surfaces
    do b = 1, size(walls)
      if (walls(b)%kind == 'mesh' .and. walls(b)%blocks_gas()) surfaces(b) = wall_within(surfaces(b), chamber%lower, chamber%upper)
    end do
    call open_up(case, chamber, walls, surfaces)
    call chamber%add_walls(walls, surfaces)
  end function enclosure_of

  !> Open the faces with openings; what is left of them is added to the walls.
  pure subroutine open_up(case, chamber, walls, surfaces)
    type(case_t), intent(in) :: case
    type(chamber_t), intent(inout) :: chamber
    type(wall_settings_t), allocatable, intent(inout) :: walls(:)
    type(surface_t), allocatable, intent(inout) :: surfaces(:)

    type(wall_settings_t) :: rest
    real(wp), allocatable :: openings(:,:), triangles(:,:,:)
    integer :: side, axis

    do axis = 1, 3
      do side = 1, 2
        call find_openings(case%domain, case%boundaries, side, axis, openings)
        if (size(openings, 2) == 0) cycle
        chamber%open(side, axis) = .true.
        triangles = rest_of_face(case%domain, openings, side, axis)
        if (size(triangles, 3) == 0) cycle
        rest%kind = 'mesh'
        rest%open = .true.
        rest%rotation_centre = 0.0_wp
        rest%material = chamber%face_material(2*axis - 2 + side)
        walls = [walls, rest]
        surfaces = [surfaces, new_surface(triangles)]
      end do
    end do
  end subroutine open_up

end module enclosure
