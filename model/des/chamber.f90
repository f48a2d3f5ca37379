!> The box that holds the parcels: where it ends, what its faces do, and gravity.
module chamber
  use kinds, only: wp
  implicit none
  private
  public :: chamber_t, face_normal, n_faces

  integer, parameter :: n_faces = 6  !< low and high x, low and high y, low and high z

  !> Faces are numbered 1 to 6: low x, high x, low y, high y, low z, high z.
  type :: chamber_t
    real(wp) :: lower(3), upper(3)           !< corners [m]
    logical :: periodic(3) = .false.         !< whether opposite faces are joined
    logical :: open(2, 3) = .false.          !< low and high face of each direction: parcels leave there
    real(wp) :: gravity(3) = 0.0_wp          !< [m/s2]
  contains
    procedure :: is_wall
    procedure :: distance
  end type chamber_t

contains

  !> Whether parcels bounce off a face.
  pure function is_wall(self, face)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    logical :: is_wall

    integer :: axis

    axis = (face + 1)/2
    is_wall = .not. (self%periodic(axis) .or. self%open(face - 2*axis + 2, axis))
  end function is_wall

  !> Distance of a point from a face, positive inside [m].
  pure function distance(self, face, x)
    class(chamber_t), intent(in) :: self
    integer, intent(in) :: face
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    integer :: axis

    axis = (face + 1)/2
    if (modulo(face, 2) == 1) then
      distance = x(axis) - self%lower(axis)
    else
      distance = self%upper(axis) - x(axis)
    end if
  end function distance

  !> Unit vector from a face into the box.
  pure function face_normal(face) result(normal)
    integer, intent(in) :: face
    real(wp) :: normal(3)

    normal = 0.0_wp
    normal((face + 1)/2) = merge(1.0_wp, -1.0_wp, modulo(face, 2) == 1)
  end function face_normal

end module chamber
