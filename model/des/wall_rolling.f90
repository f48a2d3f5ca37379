!> Resistance to rolling on walls.
module wall_rolling
  use chamber, only: chamber_t
  use contact_lanes, only: lanes, full_lanes
  use contact_law, only: contact_law_t
  use kinds, only: wp
  use parcels, only: parcels_t, mass_row, spin_row, curvature_row
  use rolling, only: rolling_torques
  use wall_entries, only: wall_entries_t
  implicit none
  private
  public :: roll

contains

  !> Torques that resist rolling on the walls. The list still has the steps in which the contacts touched last.
  pure subroutine roll(self, chamber, law, touching, pair, force, parcels)
    type(wall_entries_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: touching(:)                                !< (n) entries
    real(wp), intent(in) :: pair(:,:), force(:,:)                     !< (8, n filled up to full lanes) see contact_linear
    type(parcels_t), intent(inout) :: parcels

    real(wp), dimension(3, size(touching) + lanes) :: push, angle, torque
    real(wp) :: turn(5, size(touching) + lanes)
    integer :: m, n, i, w, at, full

    n = size(touching)
    full = full_lanes(n)
    do m = 1, n
      w = touching(m)
      associate (s => parcels%state(:, self%parcel(w)))
        turn(1:3, m) = s(curvature_row)*s(spin_row:spin_row + 2) - chamber%spin_of(self%face(w))
        turn(4, m) = s(curvature_row)
        turn(5, m) = s(mass_row)*s(curvature_row)**2
        push(:, m) = force(1:3, m)
      end associate
      if (law%rolling%spring) then
        angle(:, m) = merge(self%angle(:, w), 0.0_wp, self%slip(4, w) >= self%step - 1.5_wp)
      end if
    end do
    do m = n + 1, full
      turn(:, m) = turn(:, n)
      push(:, m) = 0.0_wp
      angle(:, m) = 0.0_wp
    end do
    call rolling_torques(law%rolling, law%linear%dt, full, pair, turn, push, angle, torque)
    do m = 1, n
      w = touching(m)
      i = self%parcel(w)
      at = parcels%force_at(i) + 4
      parcels%force(at:at + 2) = parcels%force(at:at + 2) + parcels%state(curvature_row, i)*torque(:, m)
      if (law%rolling%spring) self%angle(:, w) = angle(:, m)
    end do
  end subroutine roll

end module wall_rolling
