!> A cylinder or cone without thickness: a straight generator turned about an axis.
!>
!> In the half plane through the axis and a point the nearest point of the shell is the foot of the perpendicular on
!> the generator or, where that lies beyond an end of it, the end: a point of the rim.
!>
!> A cylinder without ends has one side for parcels. A shell with ends has two: parcels may go round its rims, so no
!> side is wrong. Parcels move by less than a tenth of their radius in a step, and their centres do not come near a shell
!> they bounce off; so whose centre is nearer than `closest` radii is about to go through.
module shell
  use kinds, only: wp
  use wall_motion, only: wall_motion_t, cross
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: shell_t, new_shell, find_rim

  real(wp), parameter :: closest = 0.25_wp     !< distance of a centre from a shell with ends, over the radius [-]
  real(wp), parameter :: sameness = 1.0e-6_wp  !< distance of two rims that are one, over their size [-]

  type :: shell_t
    real(wp) :: point(3)           !< of the axis, where the generator starts [m]
    real(wp) :: axis(3)            !< unit vector
    real(wp) :: radius             !< where the generator starts [m]
    real(wp) :: generator(2)       !< unit vector, along the axis and away from it
    real(wp) :: length             !< of the generator, if it has ends [m]
    logical :: has_ends
    integer :: side = 1            !< without ends: 1 parcels inside, -1 outside
    integer :: joined(2) = 0       !< place of the shell that shares the rim at the start and at the end; 0 if none does
    type(wall_motion_t) :: motion
    integer :: material = 0        !< see contact_pairs
  contains
    procedure :: approach
    procedure :: distance
    procedure :: is_beyond
    procedure :: shares_rim
  end type shell_t

contains

  pure function new_shell(settings) result(shell)
    type(wall_settings_t), intent(in) :: settings
    type(shell_t) :: shell

    shell%point = settings%point
    shell%axis = settings%direction()
    shell%radius = settings%radius
    shell%motion = settings%motion()
    shell%material = settings%material
    if (settings%kind == 'cone') then
      shell%generator = [norm2(settings%end_point - settings%point), settings%end_radius - settings%radius]
      shell%has_ends = .true.
    else
      shell%has_ends = settings%has_length()
      shell%generator = [merge(settings%length, 1.0_wp, shell%has_ends), 0.0_wp]
      if (settings%side == 'outside') shell%side = -1
    end if
    shell%length = norm2(shell%generator)
    shell%generator = shell%generator/shell%length
  end function new_shell

  !> The way from the nearest point of the shell to a point, and its length: see `distance`.
  pure subroutine approach(self, x, way, distance, end)
    class(shell_t), intent(in) :: self
    real(wp), intent(in) :: x(3)       !< [m]
    real(wp), intent(out) :: way(3)    !< [m]
    real(wp), intent(out) :: distance  !< [m]
    integer, intent(out) :: end        !< of the generator, where the nearest point is on a rim: 1 start, 2 end; else 0

    real(wp) :: away(3), height, rho, t, gap(2)

    height = dot_product(x - self%point, self%axis)
    away = x - self%point - height*self%axis
    rho = norm2(away)
    gap = [height, rho - self%radius]
    t = dot_product(gap, self%generator)
    end = 0
    if (self%has_ends) then
      if (t < 0.0_wp) end = 1
      if (t > self%length) end = 2
      t = min(max(t, 0.0_wp), self%length)
    end if
    gap = gap - t*self%generator
    if (rho > 0.0_wp) then
      away = away/rho
    else
      away = across(self%axis)
    end if
    way = gap(1)*self%axis + gap(2)*away
    if (self%has_ends) then
      distance = norm2(gap)
    else
      distance = -self%side*gap(2)
    end if
  end subroutine approach

  !> Distance of a point from the shell; negative beyond one that has no ends [m].
  pure function distance(self, x)
    class(shell_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    real(wp) :: way(3)
    integer :: end

    call self%approach(x, way, distance, end)
  end function distance

  !> Whether a parcel at this distance is on the wrong side or going there.
  pure function is_beyond(self, distance, radius)
    class(shell_t), intent(in) :: self
    real(wp), intent(in) :: distance, radius  !< [m]
    logical :: is_beyond

    is_beyond = .not. distance > merge(closest*radius, 0.0_wp, self%has_ends)
  end function is_beyond

  !> A unit vector across another.
  pure function across(axis)
    real(wp), intent(in) :: axis(3)
    real(wp) :: across(3)

    integer :: a

    a = minloc(abs(axis), dim=1)
    across = -axis(a)*axis
    across(a) = across(a) + 1.0_wp
    across = across/norm2(across)
  end function across

  !> Whether an end of this shell is the same circle as one of the ends of another.
  pure function shares_rim(self, end, other) result(same)
    class(shell_t), intent(in) :: self
    integer, intent(in) :: end  !< 1 or 2
    type(shell_t), intent(in) :: other
    logical :: same

    real(wp) :: centre(3), other_centre(3), radius, other_radius, near
    integer :: m

    same = .false.
    if (.not. (self%has_ends .and. other%has_ends)) return
    call find_rim(self, end, centre, radius)
    near = sameness*max(self%length, other%length, radius)
    do m = 1, 2
      call find_rim(other, m, other_centre, other_radius)
      same = same .or. (norm2(centre - other_centre) <= near .and. abs(radius - other_radius) <= near &
                        .and. norm2(cross(self%axis, other%axis)) <= sameness)
    end do
  end function shares_rim

  !> The circle that ends a shell.
  pure subroutine find_rim(shell, end, centre, radius)
    type(shell_t), intent(in) :: shell
    integer, intent(in) :: end
    real(wp), intent(out) :: centre(3), radius  !< [m]

    real(wp) :: t

    t = merge(0.0_wp, shell%length, end == 1)
    centre = shell%point + t*shell%generator(1)*shell%axis
    radius = shell%radius + t*shell%generator(2)
  end subroutine find_rim

end module shell
