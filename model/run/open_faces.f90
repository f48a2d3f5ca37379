!> Where parcels leave the domain: faces that are open as a whole, and openings in others.
!>
!> A face with openings is no wall of the chamber: what is left of it is a mesh without thickness, from opening to opening. So the
!> edges of an opening are felt as edges, and who is through has left the domain.
module open_faces
  use boundary_settings, only: boundary_settings_t
  use domain_settings, only: domain_settings_t
  use kinds, only: wp
  use sorting, only: ascending
  implicit none
  private
  public :: find_openings, rest_of_face

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of the domain: what counts as lying on a face or an edge of it

contains

  !> The openings of a face: regions that are open to parcels, as far as they lie on it.
  pure subroutine find_openings(domain, boundaries, side, axis, openings)
    type(domain_settings_t), intent(in) :: domain
    type(boundary_settings_t), intent(in) :: boundaries(:)
    integer, intent(in) :: side                             !< 1 the low face, 2 the high one
    integer, intent(in) :: axis
    real(wp), allocatable, intent(out) :: openings(:,:)     !< (4,n) 1:2 lowest corner, 3:4 highest [m], in the two directions
                                                            !< that follow the axis

    real(wp) :: place, near(3), lower(2), upper(2), found(4, size(boundaries))
    integer :: across(2), b, n

    across = [modulo(axis, 3) + 1, modulo(axis + 1, 3) + 1]
    near = closeness*(domain%upper - domain%lower)
    place = merge(domain%lower(axis), domain%upper(axis), side == 1)
    n = 0
    do b = 1, merge(0, size(boundaries), domain%periodic(axis))
      associate (region => boundaries(b))
        if (region%parcels /= 'open') cycle
        if (region%lower(axis) > place + near(axis) .or. region%upper(axis) < place - near(axis)) cycle
        lower = clipped(region%lower(across))
        upper = clipped(region%upper(across))
        if (any(upper - lower <= near(across))) cycle
        n = n + 1
        found(:, n) = [lower, upper]
      end associate
    end do
    openings = found(:, :n)

  contains

    !> To the edges of the face, also where it is close to one.
    pure function clipped(corner)
      real(wp), intent(in) :: corner(2)  !< [m]
      real(wp) :: clipped(2)

      clipped = merge(domain%lower(across), corner, corner < domain%lower(across) + near(across))
      clipped = merge(domain%upper(across), clipped, corner > domain%upper(across) - near(across))
    end function clipped
  end subroutine find_openings

  !> Triangles that cover a face but for its openings; none if they cover it. The edges of all openings, prolonged, cut it into
  !> rectangles, so that all neighbours share whole edges.
  pure function rest_of_face(domain, openings, side, axis) result(triangles)
    type(domain_settings_t), intent(in) :: domain
    real(wp), intent(in) :: openings(:,:)  !< (4,n), see find_openings
    integer, intent(in) :: side, axis
    real(wp), allocatable :: triangles(:,:,:)  !< (3,3,2m) corners [m]

    real(wp), allocatable :: x(:), y(:)
    real(wp) :: middle(2), corner(3, 4), found(3, 3, 2*(2*size(openings, 2) + 1)**2)
    integer :: across(2), i, j, n

    across = [modulo(axis, 3) + 1, modulo(axis + 1, 3) + 1]
    call cut(domain%lower(across(1)), domain%upper(across(1)), [openings(1, :), openings(3, :)], x)
    call cut(domain%lower(across(2)), domain%upper(across(2)), [openings(2, :), openings(4, :)], y)
    corner(axis, :) = merge(domain%lower(axis), domain%upper(axis), side == 1)
    n = 0
    do j = 1, size(y) - 1
      do i = 1, size(x) - 1
        middle = 0.5_wp*[x(i) + x(i + 1), y(j) + y(j + 1)]
        if (any(openings(1, :) < middle(1) .and. middle(1) < openings(3, :) .and. &
                openings(2, :) < middle(2) .and. middle(2) < openings(4, :))) cycle
        corner(across(1), :) = x([i, i + 1, i + 1, i])
        corner(across(2), :) = y([j, j, j + 1, j + 1])
        found(:, :, n + 1) = corner(:, [1, 2, 3])
        found(:, :, n + 2) = corner(:, [1, 3, 4])
        n = n + 2
      end do
    end do
    triangles = found(:, :, :n)
  end function rest_of_face

  !> The ends of an interval and the places between at which it is cut, in ascending order; of those close to each other one.
  pure subroutine cut(lower, upper, places, ends)
    real(wp), intent(in) :: lower, upper, places(:)    !< [m]
    real(wp), allocatable, intent(out) :: ends(:)      !< [m]

    real(wp) :: sorted(size(places) + 2)
    integer :: m

    sorted = [lower, places, upper]
    sorted = sorted(ascending(sorted))
    ends = pack(sorted, [.true., (sorted(m) - sorted(m - 1) > closeness*(upper - lower), m=2, size(sorted))])
    ends(size(ends)) = upper
  end subroutine cut

end module open_faces
