!> How far beyond contact pairs are listed where the case does not say.
!>
!> Wide lists last longer, but have more pairs, of which some are chosen every few steps. A dense bed is fastest with 0.4 of a
!> diameter. Where parcels are few, making a list costs more than its pairs: the skin is the one with which about as many pairs
!> are listed as in a bed, up to twice as wide.
module list_skin
  use chamber, only: chamber_t
  use kinds, only: wp
  use solids_trouble, only: least_period
  implicit none
  private
  public :: widest_skin, fitting_skin, skin_within

  real(wp), parameter :: narrowest_skin = 0.4_wp, widest_skin = 0.8_wp  !< over the width of a parcel
  real(wp), parameter :: least_skin = 0.1_wp     !< the same, where a period is too short for more
  real(wp), parameter :: usual_pairs = 6.0_wp    !< listed for a parcel of a bed
  real(wp), parameter :: fewest_pairs = 0.01_wp  !< that make a difference

contains

  !> The skin with which a parcel would have the usual number of pairs, as these go with the volume around it [m].
  pure function fitting_skin(skin, width, pairs) result(fitting)
    real(wp), intent(in) :: skin   !< of a list [m]
    real(wp), intent(in) :: width  !< of a parcel [m]
    real(wp), intent(in) :: pairs  !< in this list, per parcel
    real(wp) :: fitting

    fitting = (width + skin)*(usual_pairs/max(pairs, fewest_pairs))**(1.0_wp/3.0_wp) - width
  end function fitting_skin

  !> A skin within its limits, one of which is the room of a chamber with periodic directions [m].
  pure function skin_within(chamber, range, width, skin) result(within)
    type(chamber_t), intent(in) :: chamber
    real(wp), intent(in) :: range  !< of contacts, without skin [m]
    real(wp), intent(in) :: width  !< of a parcel [m]
    real(wp), intent(in) :: skin   !< asked for [m]
    real(wp) :: within

    real(wp) :: room

    room = minval((chamber%upper - chamber%lower)/least_period, mask=chamber%periodic) - range
    within = max(min(skin, widest_skin*width), narrowest_skin*width)
    within = max(min(within, room), least_skin*width)
  end function skin_within

end module list_skin
