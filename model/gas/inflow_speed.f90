!> How fast gas comes in through the faces of each record, which may give a velocity, a flow or a table.
module inflow_speed
  use boundary_settings, only: boundary_settings_t
  use constants, only: is_set
  use kinds, only: wp
  implicit none
  private
  public :: superficial, strength

contains

  !> Superficial velocity into the domain of each record, its mean over the faces [m/s]; 0 for all but inflows.
  pure function superficial(records, area, shaped, density) result(speed)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:)   !< [m2]
    real(wp), intent(in) :: shaped(:)  !< sums of area times share
    real(wp), intent(in) :: density   !< [kg/m3]
    real(wp) :: speed(size(records))

    integer :: m

    speed = 0.0_wp
    do m = 1, size(records)
      if (records(m)%kind /= 'inflow' .or. .not. area(m) > 0.0_wp) cycle
      if (is_set(records(m)%velocity)) then
        speed(m) = records(m)%velocity
      else if (is_set(records(m)%volume_flow)) then
        speed(m) = records(m)%volume_flow/area(m)
      else if (is_set(records(m)%mass_flow)) then
        speed(m) = records(m)%mass_flow/(density*area(m))
      else
        speed(m) = shaped(m)/area(m)
      end if
    end do
  end function superficial

  !> What the share of a face is multiplied by to be its velocity: with a profile the mean is the velocity of the record.
  pure function strength(records, speed, area, shaped) result(factor)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: speed(:)   !< [m/s]
    real(wp), intent(in) :: area(:)    !< [m2]
    real(wp), intent(in) :: shaped(:)  !< sums of area times share
    real(wp) :: factor(size(records))

    factor = speed
    where (records%profile /= 'uniform' .and. shaped > 0.0_wp) factor = speed*area/max(shaped, tiny(1.0_wp))
  end function strength

end module inflow_speed
