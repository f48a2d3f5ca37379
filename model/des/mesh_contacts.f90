!> Where a parcel touches a wall of triangles.
!>
!> A contact is where the distance from the centre is least among all points near by. On a triangle that is one point, its nearest
!> one; where it lies on an edge or in a corner it counts if no other triangle there comes nearer. So a ball has one contact with a
!> plane, however many triangles it touches, one with an edge that sticks out, one with each side of a groove.
!>
!> Of contacts whose directions differ by less than `smooth` the deepest counts: triangles that continue each other, or bend as
!> those of a rounded wall do, are felt as one. So the force has an energy, (k/2) delta^2 of the deepest, also where the ball
!> comes from one to the next.
module mesh_contacts
  use kinds, only: wp
  use mesh_wall, only: mesh_wall_t
  implicit none
  private
  public :: find_contacts, hand_over

  real(wp), parameter :: smooth = 0.93969262078590838_wp     !< cosine of 20 degrees
  real(wp), parameter :: continued = 0.86602540378443865_wp  !< cosine of the angle by which a contact turns in a step, 30 degrees
  real(wp), parameter :: far = 1.2_wp                        !< farther than any triangle is of which a slip comes, over the radius
  real(wp), parameter :: nowhere = 1.0e100_wp                !< distance of those that are farther [m]
  real(wp), parameter :: round_off = 1.0e-9_wp               !< of distances [-]

contains

  !> The contacts of a parcel with the triangles near it, the deepest first.
  pure subroutine find_contacts(wall, triangle, place, radius, gap, chosen, n)
    type(mesh_wall_t), intent(in) :: wall
    integer, intent(in) :: triangle(:)    !< (k)
    real(wp), intent(in) :: place(:,:)    !< (3,k) of the parcel for each triangle, as the wall sees it [m]
    real(wp), intent(in) :: radius        !< [m]
    real(wp), intent(out) :: gap(:,:)     !< (4,k) 1:3 way from the nearest point of each triangle, 4 its length [m];
                                          !< of those that are far no way, and a length without end
    integer, intent(out) :: chosen(:)     !< (n) which of the triangles have a contact
    integer, intent(out) :: n

    integer :: bearers(2, size(triangle)), k
    logical :: left(size(triangle))

    do k = 1, size(triangle)
      if (wall%is_apart(triangle(k), place(:, k), far*radius)) then
        gap(:, k) = [0.0_wp, 0.0_wp, 0.0_wp, nowhere]
        bearers(:, k) = 0
        cycle
      end if
      call wall%approach(triangle(k), place(:, k), gap(1:3, k), gap(4, k), bearers(:, k))
    end do
    left = gap(4, :) < radius
    n = 0
    do
      k = minloc(gap(4, :), dim=1, mask=left)
      if (k == 0) return
      left(k) = .false.
      if (.not. is_least(wall, triangle, gap, bearers(:, k), k)) cycle
      n = n + 1
      chosen(n) = k
      left = left .and. .not. matmul(gap(1:3, k), gap(1:3, :)) > smooth*gap(4, k)*gap(4, :)
    end do
  end subroutine find_contacts

  !> Whether no triangle that has the nearest point of triangle k comes nearer.
  pure function is_least(wall, triangle, gap, bearers, k)
    type(mesh_wall_t), intent(in) :: wall
    integer, intent(in) :: triangle(:)
    real(wp), intent(in) :: gap(:,:)
    integer, intent(in) :: bearers(2)
    integer, intent(in) :: k
    logical :: is_least

    integer :: m

    is_least = .true.
    if (bearers(1) == 0) return
    do m = 1, size(triangle)
      if (gap(4, m) >= (1 - round_off)*gap(4, k)) cycle
      associate (corner => wall%corner(:, triangle(m)))
        if (any(corner == bearers(1)) .and. (bearers(2) == 0 .or. any(corner == bearers(2)))) is_least = .false.
      end associate
    end do
  end function is_least

  !> A contact that is on another triangle than in the step before keeps its slip, and angle: it is the one whose direction was
  !> nearest.
  pure subroutine hand_over(step, gap, chosen, slip, angle)
    real(wp), intent(in) :: step          !< number of this step
    real(wp), intent(in) :: gap(:,:)      !< (4,k), see find_contacts
    integer, intent(in) :: chosen(:)      !< triangles that have a contact
    real(wp), intent(inout) :: slip(:,:)  !< (4,k) 1:3 slip [m], 4 step of the last touch
    real(wp), intent(inout), optional :: angle(:,:)  !< (3,k) angle rolled, where there is a rolling spring [rad]

    real(wp) :: likeness(size(slip, 2))
    logical :: free(size(slip, 2))
    integer :: c, k, m

    free = slip(4, :) >= step - 1.5_wp
    free(chosen) = .false.
    if (.not. any(free)) return
    do m = 1, size(chosen)
      c = chosen(m)
      if (slip(4, c) >= step - 1.5_wp) cycle
      likeness = matmul(gap(1:3, c), gap(1:3, :))/(gap(4, c)*max(gap(4, :), tiny(step)))
      k = maxloc(likeness, dim=1, mask=free)
      if (k == 0) return
      if (likeness(k) < continued) cycle
      slip(:, c) = slip(:, k)
      if (present(angle)) angle(:, c) = angle(:, k)
      slip(4, k) = 0.0_wp
      free(k) = .false.
    end do
  end subroutine hand_over

end module mesh_contacts
