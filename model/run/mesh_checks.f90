!> Mistakes of walls that are meshes: holes, places outside the domain, fillings that they pass through.
module mesh_checks
  use case, only: case_t
  use case_keys, only: keys_t
  use constants, only: is_set, pi
  use kinds, only: wp
  use mesh_rims, only: loose_rim, wall_within
  use surface, only: surface_t
  use text, only: shown, brief
  use wall_motion, only: wall_motion_t, cross
  implicit none
  private
  public :: check_meshes, meets_box, find_reach

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of the domain: what counts as lying on a plane

contains

  !> Add to keys%problems; what cannot be checked because of other mistakes is passed over.
  subroutine check_meshes(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: w

    if (.not. all(is_set([case%domain%lower, case%domain%upper]))) return
    if (.not. all(case%domain%upper > case%domain%lower)) return
    do w = 1, size(case%walls)
      if (case%surfaces(w)%n == 0) cycle
      call check_place(case, w, keys)
      if (size(case%surfaces(w)%open_edge, 2) > 0 .and. .not. (case%walls(w)%open .or. case%walls(w)%blocks_gas())) then
        call keys%require_at(.false., 'wall', w, 'file', 'is not closed: '//opening_words(case%surfaces(w)))
      end if
      call check_fills(case, w, keys)
    end do
  end subroutine check_meshes

  pure function opening_words(surface) result(words)
    type(surface_t), intent(in) :: surface
    character(len=:), allocatable :: words, place

    place = triple(0.5_wp*sum(surface%vertex(:, surface%open_edge(:, 1)), 2))
    words = shown(size(surface%open_edge, 2))//' edges have a triangle on one side only, the first at '//place
    if (size(surface%open_edge, 2) == 1) words = 'an edge has a triangle on one side only, at '//place
    words = words//' m; give open = true if that is meant'
  end function opening_words

  !> A mesh that keeps the gas on one side ends nowhere in the domain.
  subroutine check_rims(case, w, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: w
    type(keys_t), intent(inout) :: keys

    type(surface_t) :: within
    real(wp) :: place(3)
    logical :: loose

    within = wall_within(case%surfaces(w), case%domain%lower, case%domain%upper)
    call keys%require_at(within%n > 0, 'wall', w, 'gas_side', 'all of its file lies on or beyond faces of the domain')
    call loose_rim(case%surfaces(w), case%domain%lower, case%domain%upper, loose, place)
    call keys%require_at(.not. loose, 'wall', w, 'gas_side', 'its file has a rim at '//triple(place)//' m: the gas has a side ' &
                         //'of a mesh that is closed, or whose rims each lie on or beyond one face of the domain')
  end subroutine check_rims

  !> A mesh lies in the domain, off its faces, as long as the run lasts; one that keeps the gas on one side may go on beyond.
  subroutine check_place(case, w, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: w
    type(keys_t), intent(inout) :: keys

    type(wall_motion_t) :: motion
    real(wp) :: near(3), lower(3), upper(3)
    integer :: v, t, f

    associate (domain => case%domain, surface => case%surfaces(w))
      near = closeness*(domain%upper - domain%lower)
      lower = minval(surface%vertex, dim=2)
      upper = maxval(surface%vertex, dim=2)
      if (any(lower > domain%upper) .or. any(upper < domain%lower)) then
        call keys%require_at(.false., 'wall', w, '', 'lies outside the domain: it is at '//triple(0.5_wp*(lower + upper)) &
                             //' m, '//brief(maxval(upper - lower))//' m large; is its scale right?')
        return
      end if
      if (case%walls(w)%blocks_gas()) then
        call check_rims(case, w, keys)
        return
      end if
      if (any(lower < domain%lower - near) .or. any(upper > domain%upper + near)) then
        call keys%require_at(.false., 'wall', w, '', 'reaches out of the domain: it goes from '//triple(lower)//' to ' &
                             //triple(upper)//' m')
        return
      end if
      do t = 1, surface%n
        associate (x => surface%vertex(:, surface%corner(:, t)))
          do f = 1, 3
            if (domain%periodic(f)) cycle
            if (any(abs(x(f, :) - domain%lower(f)) > near(f)) .and. any(abs(x(f, :) - domain%upper(f)) > near(f))) cycle
            call keys%require_at(.false., 'wall', w, '', 'has a triangle in a face of the domain, at ' &
                                 //triple(sum(x, 2)/3)//' m, where parcels would feel both: move the face outward')
            return
          end do
        end associate
      end do
      motion = case%walls(w)%motion()
      if (case%walls(w)%stays .or. motion%is_still() .or. .not. is_set(case%run%end_time)) return
      do v = 1, size(surface%vertex, 2)
        call find_reach(motion, surface%vertex(:, v), case%run%end_time, lower, upper)
        if (all(lower >= domain%lower - near) .and. all(upper <= domain%upper + near)) cycle
        call keys%require_at(.false., 'wall', w, '', 'moves out of the domain before the end of the run: its corner at ' &
                             //triple(surface%vertex(:, v))//' m comes to '//triple(merge(lower, upper, &
                             domain%lower - lower > upper - domain%upper))//' m')
        return
      end do
    end associate
  end subroutine check_place

  !> A filling lies on one side of the mesh as it is at the start.
  subroutine check_fills(case, w, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: w
    type(keys_t), intent(inout) :: keys

    real(wp) :: near
    integer :: f, t

    near = closeness*maxval(case%domain%upper - case%domain%lower)
    associate (surface => case%surfaces(w))
      do f = 1, size(case%fills)
        associate (fill => case%fills(f))
          if (.not. all(is_set([fill%lower, fill%upper]))) cycle
          if (any(fill%upper - fill%lower <= 2*near)) cycle
          do t = 1, surface%n
            if (.not. meets_box(surface%vertex(:, surface%corner(:, t)), fill%lower + near, fill%upper - near)) cycle
            call keys%require_at(.false., 'fill', f, '', 'its box reaches through &wall('//trim(case%walls(w)%id) &
                                 //'), whose triangle at '//triple(sum(surface%vertex(:, surface%corner(:, t)), 2)/3) &
                                 //' m is in it')
            exit
          end do
        end associate
      end do
    end associate
  end subroutine check_fills

  !> Whether a triangle and a box have a point in common: no plane parts them, of those along a face of either or along an edge
  !> of both. Source: Ericson, Real-Time Collision Detection, Morgan Kaufmann 2005, section 5.2.9.
  pure function meets_box(corners, lower, upper) result(meets)
    real(wp), intent(in) :: corners(3, 3)       !< of the triangle [m]
    real(wp), intent(in) :: lower(3), upper(3)  !< of the box [m]
    logical :: meets

    real(wp) :: x(3, 3), half(3), edge(3), unit(3)
    integer :: k, a

    half = 0.5_wp*(upper - lower)
    x = corners - spread(0.5_wp*(lower + upper), 2, 3)
    meets = .not. parts(cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1)))
    do a = 1, 3
      unit = 0.0_wp
      unit(a) = 1.0_wp
      meets = meets .and. .not. parts(unit)
      do k = 1, 3
        edge = x(:, modulo(k, 3) + 1) - x(:, k)
        meets = meets .and. .not. parts(cross(unit, edge))
      end do
    end do

  contains

    pure function parts(normal)
      real(wp), intent(in) :: normal(3)
      logical :: parts

      real(wp) :: heights(3), reach

      heights = matmul(normal, x)
      reach = dot_product(half, abs(normal))
      parts = minval(heights) > reach .or. maxval(heights) < -reach
    end function parts
  end function meets_box

  !> The box in which a point of a moving wall stays. Turning, each of its coordinates is c + p cos(angle) + q sin(angle), largest
  !> and least where tan(angle) = q/p.
  pure subroutine find_reach(motion, x, time, lower, upper)
    type(wall_motion_t), intent(in) :: motion
    real(wp), intent(in) :: x(3), time             !< [m], [s]
    real(wp), intent(out) :: lower(3), upper(3)    !< [m]

    real(wp) :: axis(3), arm(3), p(3), q(3), whole, angles(4), places(4)
    integer :: a

    axis = 0.0_wp
    if (norm2(motion%spin) > 0.0_wp) axis = motion%spin/norm2(motion%spin)
    whole = min(norm2(motion%spin)*time, 2*pi)
    arm = x - motion%centre
    p = arm - dot_product(arm, axis)*axis
    q = cross(axis, arm)
    do a = 1, 3
      angles = [0.0_wp, whole, 0.0_wp, 0.0_wp]
      if (abs(p(a)) + abs(q(a)) > 0.0_wp) angles(3) = modulo(atan2(q(a), p(a)), 2*pi)
      angles(4) = modulo(angles(3) + pi, 2*pi)
      angles = min(angles, whole)
      places = x(a) - p(a) + p(a)*cos(angles) + q(a)*sin(angles)
      lower(a) = minval(places) + min(0.0_wp, time*motion%velocity(a))
      upper(a) = maxval(places) + max(0.0_wp, time*motion%velocity(a))
    end do
  end subroutine find_reach

  pure function triple(x) result(text)
    real(wp), intent(in) :: x(3)  !< [m]
    character(len=:), allocatable :: text

    text = brief(x(1))//', '//brief(x(2))//', '//brief(x(3))
  end function triple

end module mesh_checks
